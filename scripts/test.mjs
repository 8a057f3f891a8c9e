/**
 * `npm test`: sets up what is missing, then runs every check, going on after one that fails. Words after `--` pick
 * checks by name: `npm test -- python` runs those whose name contains "python".
 */
import { join } from 'node:path'

import { collect, elapsed, installedFile, root, run, SetupError } from './process.mjs'
import { venvProgram } from './python.mjs'
import {
  ensureBrowser,
  ensureDemoPage,
  ensureMaps,
  ensureNodePackages,
  ensurePython,
} from './setup.mjs'

/** A check that takes longer than this hangs, ms. */
const timeout = 20 * 60_000

/**
 * @param {string} file relative to node_modules
 * @param {string[]} args
 */
const node = (file, ...args) => [process.execPath, installedFile(file), ...args]

/**
 * @param {string} name of a program of the virtual environment
 * @param {string[]} args
 */
const python = (name, ...args) => [join(root, venvProgram(name)), ...args]

/** @param {string} project */
const vitest = (project) => node('vitest/vitest.mjs', 'run', '--project', project)

const everything = [ensureNodePackages, ensurePython, ensureMaps, ensureBrowser, ensureDemoPage]

/** What reads sources alone, each in one process; they run side by side. */
const readings = [
  { name: 'python lint', needs: [ensurePython], command: python('ruff', 'check', '.') },
  {
    name: 'python format',
    needs: [ensurePython],
    command: python('ruff', 'format', '--check', '.'),
  },
  {
    name: 'python types',
    needs: [ensureNodePackages, ensurePython],
    command: node('pyright/index.js'),
  },
  { name: 'web lint', needs: [ensureNodePackages], command: node('eslint/bin/eslint.js', '.') },
  {
    name: 'web format',
    needs: [ensureNodePackages],
    command: node('prettier/bin/prettier.cjs', '--check', '.'),
  },
  { name: 'web types', needs: [ensureNodePackages], command: node('typescript/bin/tsc') },
]

/** What runs the project, one after the other: each uses all cores that there are. */
const runs = [
  { name: 'build', needs: everything, command: [process.execPath, 'scripts/build.mjs'] },
  {
    name: 'python tests',
    needs: everything,
    // A file's tests stay together: they share what its fixtures make.
    command: python('pytest', '--numprocesses=logical', '--dist=loadfile'),
  },
  { name: 'web tests', needs: everything, command: vitest('web') },
  { name: 'docs tests', needs: everything, command: vitest('docs') },
  { name: 'package tests', needs: everything, command: vitest('package') },
  { name: 'browser tests', needs: everything, command: vitest('browser') },
]

/** What has been set up, and why that failed where it did. @type {Map<() => Promise<void>, string>} */
const setUp = new Map()

/**
 * @param {(() => Promise<void>)[]} needs
 * @returns {Promise<string>} why one of them cannot be met, or nothing
 */
async function meet(needs) {
  for (const need of needs) {
    if (!setUp.has(need)) {
      try {
        await need()
        setUp.set(need, '')
      } catch (error) {
        if (!(error instanceof SetupError)) throw error
        setUp.set(need, error.message)
      }
    }
    const problem = setUp.get(need)
    if (problem) return problem
  }
  return ''
}

const words = process.argv.slice(2)

/** @param {typeof readings} checks */
function chosen(checks) {
  return checks.filter(
    ({ name }) => words.length === 0 || words.some((word) => name.includes(word)),
  )
}

/** @type {{ passed: boolean, result: string }[]} */
const results = []

/** @param {string} name @param {boolean} passed @param {number} start */
function conclude(name, passed, start) {
  const result = `${passed ? 'passed' : 'FAILED'}  ${name}  ${elapsed(start)}`
  console.log(result)
  results.push({ passed, result })
}

const prepared = []
for (const check of chosen(readings)) prepared.push({ ...check, problem: await meet(check.needs) })
await Promise.all(
  prepared.map(async ({ name, command, problem }) => {
    const start = performance.now()
    const [program = '', ...args] = command
    const { passed, output } = problem
      ? { passed: false, output: problem }
      : await collect(program, args, { timeout })
    console.log(`\n▶ ${name}\n${output.trimEnd()}`)
    conclude(name, passed, start)
  }),
)
for (const { name, needs, command } of chosen(runs)) {
  const problem = await meet(needs)
  console.log(`\n▶ ${name}`)
  if (problem) console.log(problem)
  const start = performance.now()
  const [program = '', ...args] = command
  conclude(name, !problem && (await run(program, args, { timeout })), start)
}

const passed = results.filter((result) => result.passed).length
const failed = results.length - passed
console.log(
  ['', ...results.map(({ result }) => result), `${passed} passed, ${failed} failed`].join('\n'),
)
if (failed > 0 || passed === 0) process.exitCode = 1
