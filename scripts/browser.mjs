import { join, resolve } from 'node:path'

import { chromium } from 'playwright-core'
import { createServer, preview } from 'vite'

import { ensureDemoPage } from './demo-page.mjs'
import { findBrowser } from './find-browser.mjs'
import { root, SetupError } from './process.mjs'

const commonArguments = [
  '--no-sandbox',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  '--ignore-gpu-blocklist',
  '--disable-dev-shm-usage',
]

/**
 * llvmpipe: Mesa on the processor, cosine accurate to 7.5e-8; for numbers and run times. Linux only.
 * swiftshader: Chromium's own, cosine off by up to 1.9e-4; stands in for a poor mobile GPU.
 */
const backendArguments = {
  llvmpipe: ['--use-angle=gl-egl'],
  swiftshader: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
}

/**
 * Starts a headless Chromium that renders in software.
 *
 * @param {{ backend: keyof typeof backendArguments, env?: Record<string, string> }} options
 *   env: variables beside this process' own, such as LP_NUM_THREADS
 */
export async function launchBrowser({ backend, env = {} }) {
  const executablePath = await findBrowser()
  if (!executablePath) throw new SetupError('No Chromium or Chrome found: set CHROMIUM_PATH to one')
  if (backend === 'llvmpipe' && process.platform !== 'linux') {
    throw new SetupError(`Backend llvmpipe needs Linux, not ${process.platform}`)
  }
  return chromium.launch({
    executablePath,
    headless: true,
    args: [...commonArguments, ...backendArguments[backend]],
    // On a machine with a GPU too, Mesa is to render on the processor.
    env: { ...process.env, LIBGL_ALWAYS_SOFTWARE: '1', ...env },
  })
}

/**
 * Serves a folder's pages, with what they import from anywhere in the repository, on a free port.
 *
 * @param {string} folder absolute, or relative to the repository
 * @returns {Promise<{ url: string, close: () => Promise<void> }>} url ends with a slash
 */
export async function serve(folder) {
  const server = await createServer({
    configFile: join(root, 'vite.config.ts'),
    root: resolve(root, folder),
    logLevel: 'error',
    // Nothing may reload a page in mid-test.
    server: { port: 0, hmr: false, watch: null },
  })
  await server.listen()
  const url = server.resolvedUrls?.local[0]
  if (!url) throw new Error(`The server for ${folder} has no local address`)
  return { url, close: () => server.close() }
}

/**
 * Serves the built demo page on a free port, having built it where it is not there.
 *
 * @returns {Promise<{ url: string, close: () => Promise<void> }>} url ends with a slash
 */
export async function serveDemo() {
  await ensureDemoPage()
  const server = await preview({
    configFile: join(root, 'vite.config.ts'),
    logLevel: 'error',
    preview: { port: 0 },
  })
  const url = server.resolvedUrls?.local[0]
  if (!url) throw new Error('The server for the demo page has no local address')
  return { url, close: () => server.close() }
}
