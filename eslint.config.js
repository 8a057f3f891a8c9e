import js from '@eslint/js'
import globals from 'globals'
import { defineConfig, globalIgnores } from 'eslint/config'
import tseslint from 'typescript-eslint'

export default defineConfig(
  globalIgnores(['dist/', 'maps/', 'docs/', '.venv/', '.cache/', 'tests/output/']),
  { linterOptions: { reportUnusedDisableDirectives: 'error' } },
  js.configs.recommended,
  {
    files: ['**/*.{js,mjs}'],
    languageOptions: { globals: globals.node },
  },
  {
    // Pages, and what the drivers of the browser tests run inside them.
    files: ['tests/**/*.{js,mjs}', 'demo/**/*.js'],
    languageOptions: { globals: globals.browser },
  },
  {
    files: ['**/*.{ts,tsx}'],
    extends: [tseslint.configs.strictTypeChecked],
    languageOptions: {
      parserOptions: { projectService: true, tsconfigRootDir: import.meta.dirname },
    },
    rules: {
      '@typescript-eslint/restrict-template-expressions': ['error', { allowNumber: true }],
      // An index known to lie inside an array is said so with `!`; the alternative under
      // noUncheckedIndexedAccess, `?? 0`, would hide the mistake when it is not.
      '@typescript-eslint/no-non-null-assertion': 'off',
    },
  },
)
