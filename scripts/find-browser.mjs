import { spawnSync } from 'node:child_process'
import { existsSync } from 'node:fs'
import { delimiter, dirname, join } from 'node:path'

import { installedFile, runQuietly, SetupError } from './process.mjs'

const names = ['chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable', 'chrome']

/** Where Chrome is installed without being on the PATH. */
const usualPlaces = [
  '/Applications/Google Chrome.app/Contents/MacOS/Google Chrome',
  '/Applications/Chromium.app/Contents/MacOS/Chromium',
  ...['PROGRAMFILES', 'PROGRAMFILES(X86)', 'LOCALAPPDATA'].map((variable) =>
    join(process.env[variable] ?? '', 'Google', 'Chrome', 'Application', 'chrome.exe'),
  ),
]

const aptGet = '/usr/bin/apt-get'
const mesaPackages = ['libegl1', 'libegl-mesa0', 'libgl1-mesa-dri', 'libgles2']

/**
 * Whether there is a browser, and not a distribution's stub, which has no version to tell.
 *
 * @param {string} path
 */
function runs(path) {
  if (!existsSync(path)) return false
  // Chrome for Windows opens a window instead of telling its version.
  return process.platform === 'win32' || spawnSync(path, ['--version']).status === 0
}

/**
 * The Chromium or Chrome to drive: CHROMIUM_PATH, else one on the PATH, else playwright-core's own.
 *
 * @returns {Promise<string | undefined>} its path
 */
export async function findBrowser() {
  const chosen = process.env.CHROMIUM_PATH
  if (chosen) {
    if (!runs(chosen)) throw new SetupError(`CHROMIUM_PATH: ${chosen} is no browser that runs`)
    return chosen
  }
  const folders = (process.env.PATH ?? '').split(delimiter).filter(Boolean)
  const onPath = names.flatMap((name) => folders.map((folder) => join(folder, name)))
  const installed = [...onPath, ...usualPlaces].find(runs)
  if (installed) return installed
  const { chromium } = await import('playwright-core')
  return [chromium.executablePath()].find(runs)
}

/** Whether Mesa's EGL, on which Chromium renders without a GPU, is installed. Only Linux has it. */
function hasMesa() {
  if (process.platform !== 'linux') return true
  const env = { ...process.env, PATH: `${process.env.PATH ?? ''}:/usr/sbin:/sbin` }
  const libraries = spawnSync('ldconfig', ['-p'], { encoding: 'utf8', env }).stdout ?? ''
  const mesa = /libEGL_mesa\.so\.0 .*=> (.*)/.exec(libraries)?.[1]
  // Older versions of Mesa keep the drivers in a folder, newer ones in one library.
  return (
    mesa !== undefined &&
    ['libEGL.so.1 ', 'libGLESv2.so.2 '].every((name) => libraries.includes(name)) &&
    (libraries.includes('libgallium') || existsSync(join(dirname(mesa), 'dri', 'swrast_dri.so')))
  )
}

/** @param {string[]} packages */
async function aptInstall(packages) {
  const env = { DEBIAN_FRONTEND: 'noninteractive' }
  await runQuietly('Updating the package lists', aptGet, ['update'], { env })
  const args = ['install', '-y', '--no-install-recommends', ...packages]
  await runQuietly(`Installing ${packages.join(', ')}`, aptGet, args, { env })
}

/**
 * Installs what is missing of a Chromium and, on Linux, of the Mesa libraries it renders with, where that can be
 * done; says in one line what is missing where it cannot.
 */
export async function ensureBrowser() {
  const apt = process.getuid?.() === 0 && existsSync(aptGet)
  let found = await findBrowser()
  if (!found && apt) {
    try {
      await aptInstall(['chromium', ...mesaPackages])
      found = await findBrowser()
    } catch (error) {
      // Not every distribution with apt-get packs Chromium.
      if (!(error instanceof SetupError)) throw error
      console.error(error.message)
    }
  }
  if (!found) {
    const args = [installedFile('playwright-core/cli.js'), 'install', 'chromium']
    if (apt) args.push('--with-deps')
    try {
      await runQuietly('Downloading Chromium', process.execPath, args)
    } catch (error) {
      throw new SetupError('No Chromium or Chrome found: install one, or set CHROMIUM_PATH to it', {
        cause: error,
      })
    }
    found = await findBrowser()
  }
  if (!found) throw new SetupError('The Chromium that was downloaded does not run: see above')
  if (!hasMesa() && apt) await aptInstall(mesaPackages)
  if (!hasMesa()) {
    const remedy = `on Debian: apt-get install ${mesaPackages.join(' ')}`
    throw new SetupError(
      `Mesa's EGL libraries, for rendering without a GPU, are missing (${remedy})`,
    )
  }
}
