import { createHash } from 'node:crypto'
import { cpSync, readFileSync } from 'node:fs'
import { join } from 'node:path'

import { installedFile, root, runQuietly } from './process.mjs'
import { buildWhenStale, contentHash, filesUnder } from './stamp.mjs'

/** Where the built page is. */
export const demoPage = '.cache/demo'

const serviceWorker = 'service-worker.js'
/** What demo/offline/service-worker.ts calls the list of the files to keep, which only the finished build can write. */
const precached = '__PRECACHED__'

/**
 * What a built page may do: no more than what it does. Maps and environments are fetched, environments from `data:`
 * addresses, and the page's icon is one.
 */
const policy = [
  "default-src 'none'",
  "script-src 'self'",
  "style-src 'self'",
  'img-src data:',
  "connect-src 'self' data:",
  "worker-src 'self'",
  "base-uri 'none'",
  "form-action 'none'",
].join('; ')

/** Builds the demo page, unless it is there. */
export async function ensureDemoPage() {
  const inputs = contentHash([
    'package-lock.json',
    'vite.config.ts',
    'scripts/demo-page.mjs',
    'scripts/minified-glsl.mjs',
    ...filesUnder('demo'),
    ...filesUnder('shaders'),
    ...filesUnder('web'),
    ...filesUnder('maps/baked'),
  ])
  const outputs = () => filesUnder(demoPage)
  await buildWhenStale('demo', inputs, outputs, async () => {
    const vite = [installedFile('vite/bin/vite.js'), 'build']
    // Whoever asks for it may run under another name: the tests do.
    await runQuietly('Building the page', process.execPath, vite, {
      env: { NODE_ENV: 'production' },
    })
  })
}

/**
 * Completes the built page: its policy, its maps, and in its service worker the list of all files that are kept.
 *
 * @returns {import('vite').Plugin}
 */
export function completePage() {
  const maps = filesUnder('maps/baked')
  return {
    name: 'complete-page',
    apply: 'build',
    // The page itself is among the files only then.
    enforce: 'post',
    transformIndexHtml: () => [
      {
        tag: 'meta',
        attrs: { 'http-equiv': 'Content-Security-Policy', content: policy },
        injectTo: 'head-prepend',
      },
    ],
    generateBundle(_options, bundle) {
      const worker = bundle[serviceWorker]
      if (worker?.type !== 'chunk') throw new Error(`The page was built without ${serviceWorker}`)
      const made = Object.values(bundle)
        .filter((file) => file !== worker)
        .map((file) => ({
          url: file.fileName,
          revision: hash(file.type === 'chunk' ? file.code : file.source),
        }))
      const baked = maps.map((file) => ({
        url: file,
        revision: hash(readFileSync(join(root, file))),
      }))
      if (!worker.code.includes(precached)) throw new Error(`${serviceWorker} keeps no files`)
      worker.code = worker.code.replace(precached, JSON.stringify([...made, ...baked]))
    },
    writeBundle() {
      cpSync(join(root, 'maps/baked'), join(root, demoPage, 'maps/baked'), { recursive: true })
    },
  }
}

/** @param {string | Uint8Array} content */
function hash(content) {
  return createHash('sha256').update(content).digest('hex').slice(0, 16)
}
