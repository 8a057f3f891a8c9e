import { spawn } from 'node:child_process'
import { dirname, join } from 'node:path'
import { fileURLToPath } from 'node:url'

export const root = dirname(dirname(fileURLToPath(import.meta.url)))

/** Why the set-up cannot go on, in one line a person can act on. */
export class SetupError extends Error {}

/** @param {number} start `performance.now()` then, ms */
export function elapsed(start) {
  return `${((performance.now() - start) / 1000).toFixed(1)} s`
}

/**
 * Runs a program in the repository's folder, its output going where ours goes.
 *
 * @param {string} command
 * @param {string[]} args
 * @param {{ timeout?: number, env?: Record<string, string> }} [options] timeout in ms
 * @returns {Promise<boolean>} whether it ended with status 0
 */
export function run(command, args, { timeout, env = {} } = {}) {
  return new Promise((resolve) => {
    const child = spawn(command, args, {
      cwd: root,
      stdio: ['ignore', 'inherit', 'inherit'],
      // Python's output is UTF-8 wherever it goes: quantities print their Greek symbols.
      env: { ...process.env, PYTHONUTF8: '1', ...env },
      timeout,
    })
    child.on('error', (error) => {
      console.error(error.message)
      resolve(false)
    })
    child.on('close', (status) => {
      resolve(status === 0)
    })
  })
}

/**
 * Runs a program in the repository's folder and keeps what it prints.
 *
 * @param {string} command
 * @param {string[]} args
 * @param {{ timeout?: number, env?: Record<string, string>, shell?: boolean }} [options] timeout in ms
 * @returns {Promise<{ passed: boolean, output: string, problem: string }>} whether it ended with status 0, and how it
 *   ended otherwise
 */
export function collect(command, args, { timeout, env = {}, shell = false } = {}) {
  let output = ''
  return new Promise((resolve) => {
    const child = spawn(command, args, {
      cwd: root,
      stdio: ['ignore', 'pipe', 'pipe'],
      env: { ...process.env, PYTHONUTF8: '1', ...env },
      timeout,
      shell,
    })
    for (const stream of [child.stdout, child.stderr]) {
      stream.setEncoding('utf8').on('data', (text) => (output += text))
    }
    child.on('error', (error) => {
      resolve({ passed: false, output, problem: error.message })
    })
    child.on('close', (status, signal) => {
      const problem = status === 0 ? '' : `ended with ${signal ?? `status ${status}`}`
      resolve({ passed: status === 0, output, problem })
    })
  })
}

/**
 * Runs a chatty program: prints its title and the time that has passed, and its output only if it fails.
 *
 * @param {string} title what is being done
 * @param {string} command
 * @param {string[]} args
 * @param {{ env?: Record<string, string>, shell?: boolean }} [options]
 */
export async function runQuietly(title, command, args, { env = {}, shell = false } = {}) {
  const start = performance.now()
  console.log(`${title} …`)
  const heartbeat = setInterval(() => {
    console.log(`  still at it after ${elapsed(start)}`)
  }, 15_000)
  const { passed, output, problem } = await collect(command, args, { env, shell })
  clearInterval(heartbeat)
  if (!passed) {
    console.error(output.trimEnd())
    throw new SetupError(`${title}: ${[command, ...args].join(' ')} ${problem}`)
  }
  console.log(`  done in ${elapsed(start)}`)
}

/**
 * Runs a script's body; a set-up that cannot go on is one line and status 1, not a stack trace.
 *
 * @param {() => Promise<void>} body
 */
export async function main(body) {
  try {
    await body()
  } catch (error) {
    if (!(error instanceof SetupError)) throw error
    console.error(error.message)
    // Not exitCode: a server that could not listen still keeps watching files.
    process.exit(1)
  }
}

/**
 * Passes on, as a reason to stop, what a library says about something the person at the command line got wrong.
 *
 * @param {unknown} error
 * @returns {never}
 */
export function refuse(error) {
  throw new SetupError(error instanceof Error ? error.message : String(error), { cause: error })
}

/**
 * A file of an installed npm package.
 *
 * @param {string} file relative to node_modules, with forward slashes
 */
export function installedFile(file) {
  return join(root, 'node_modules', file)
}
