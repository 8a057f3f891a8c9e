import { spawnSync } from 'node:child_process'
import { join } from 'node:path'

import { root, runQuietly, SetupError } from './process.mjs'
import { buildWhenStale, contentHash } from './stamp.mjs'

const windows = process.platform === 'win32'

/**
 * A program of the virtual environment, relative to the repository.
 *
 * @param {string} name
 */
export function venvProgram(name) {
  return windows ? `.venv/Scripts/${name}.exe` : `.venv/bin/${name}`
}

const candidates = [
  ['python3.13'],
  ['python3.12'],
  ['python3.11'],
  ['python3'],
  ['python'],
  ...(windows ? [['py', '-3']] : []),
]

/** The first Python that is new enough and can make a virtual environment. */
function findPython() {
  let lacking = ''
  for (const [command = '', ...args] of candidates) {
    const probe = 'import sys; assert sys.version_info >= (3, 11); print(sys.version.split()[0])'
    const version = spawnSync(command, [...args, '-c', probe], { encoding: 'utf8' })
    if (version.status !== 0) continue
    if (spawnSync(command, [...args, '-c', 'import ensurepip, venv']).status === 0) {
      return { command, args }
    }
    lacking ||= `${command} ${version.stdout.trim()}`
  }
  if (lacking) {
    throw new SetupError(
      `${lacking} cannot make a virtual environment: its venv module is missing (on Debian: apt-get install python3-venv)`,
    )
  }
  throw new SetupError(
    'No Python >= 3.11 found, under any of the names python3.13 to python3.11, python3, python',
  )
}

/** Makes .venv/ with exactly what requirements.txt lists, and this repository's own package. */
export async function ensurePython() {
  // The programs of an environment name its folder: a repository that was moved needs a new one.
  const inputs = contentHash(['requirements.txt', 'pyproject.toml'], [root])
  const outputs = () => ['.venv/pyvenv.cfg', venvProgram('python'), venvProgram('diffraction')]
  await buildWhenStale('python', inputs, outputs, async () => {
    const { command, args } = findPython()
    const python = join(root, venvProgram('python'))
    const pip = ['-m', 'pip', 'install', '--disable-pip-version-check', '--no-input']
    await runQuietly('Making .venv', command, [...args, '-m', 'venv', '--clear', '.venv'])
    // Wheels only: where there is none, say so at once instead of failing late in a compilation.
    await runQuietly('Installing the Python packages', python, [
      ...pip,
      '--only-binary=:all:',
      '-r',
      'requirements.txt',
    ])
    await runQuietly('Installing precompute', python, [
      ...pip,
      '--no-deps',
      '--no-build-isolation',
      '-e',
      '.',
    ])
  })
}
