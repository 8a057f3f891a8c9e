import { readFileSync } from 'node:fs'
import { basename, join } from 'node:path'

import { root, runQuietly, SetupError } from './process.mjs'
import { buildWhenStale, contentHash } from './stamp.mjs'

/**
 * Whether a version is inside a range of the two forms that package.json uses, `^20.19.0 || >=22.12.0`.
 *
 * @param {string} version
 * @param {string} range
 */
export function satisfies(version, range) {
  const [major = 0, minor = 0] = version.split('.').map(Number)
  return range.split('||').some((part) => {
    const [, kind, wantedMajor, wantedMinor] = /^(\^|>=)(\d+)\.(\d+)\.0$/.exec(part.trim()) ?? []
    if (major === Number(wantedMajor)) return minor >= Number(wantedMinor)
    return kind === '>=' && major > Number(wantedMajor)
  })
}

/** Installs exactly what package-lock.json lists. */
export async function ensureNodePackages() {
  const { engines } = JSON.parse(readFileSync(join(root, 'package.json'), 'utf8'))
  if (!satisfies(process.versions.node, engines.node)) {
    throw new SetupError(`Node ${process.versions.node} is too old: ${engines.node} is needed`)
  }
  // The bundler's compiled parts differ from platform to platform.
  const inputs = contentHash(['package-lock.json'], [process.platform, process.arch])
  const outputs = () => ['node_modules/.package-lock.json']
  await buildWhenStale('node-packages', inputs, outputs, async () => {
    const options = ['--include=dev', '--no-audit', '--no-fund', '--loglevel=error']
    await runNpm('Installing the node packages', ['ci', ...options])
  })
}

/**
 * Runs npm, the one that runs us where there is one.
 *
 * @param {string} title what is being done
 * @param {string[]} args
 */
export async function runNpm(title, args) {
  const npm = process.env.npm_execpath
  // npm is a script of its own on Windows, which only a shell can start; its JavaScript runs anywhere.
  if (npm && basename(npm).startsWith('npm')) {
    await runQuietly(title, process.execPath, [npm, ...args])
  } else {
    await runQuietly(title, 'npm', args, { shell: process.platform === 'win32' })
  }
}
