import { defineConfig } from 'vite'
import { minifiedGlsl } from './scripts/minified-glsl.mjs'

/** The npm package: one output module a source module, so that a bundler can drop what a scene leaves out. */
export default defineConfig({
  publicDir: false,
  plugins: [minifiedGlsl()],
  build: {
    target: 'es2022',
    minify: false,
    sourcemap: true,
    lib: { entry: ['web/index.ts', 'web/gltf/index.ts'], formats: ['es'] },
    rolldownOptions: {
      external: /^three(\/|$)/,
      output: {
        preserveModules: true,
        preserveModulesRoot: 'web',
        entryFileNames: '[name].js',
      },
    },
  },
})
