import { createHash } from 'node:crypto'
import { cp, mkdir, readdir, readFile, rm, writeFile } from 'node:fs/promises'
import { createServer, type Server } from 'node:http'
import type { AddressInfo } from 'node:net'
import { extname, join, normalize } from 'node:path'
import type { Browser } from 'playwright-core'
import { build as esbuild } from 'esbuild'
import { build as vite } from 'vite'
import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import webpack from 'webpack'
import { launchBrowser } from '../../scripts/browser.mjs'
import { consumer, installed, root } from './pack'

/** What every page here is served with: no eval, nothing inline, nothing from elsewhere, no text into markup. */
const POLICY = {
  'default-src': "'none'",
  'script-src': "'self'",
  'connect-src': "'self'",
  'require-trusted-types-for': "'script'",
}

const TYPES: Record<string, string> = {
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.json': 'application/json',
  '.png': 'image/png',
}

let browser: Browser

beforeAll(async () => {
  browser = await launchBrowser({ backend: 'llvmpipe' })
})

afterAll(async () => {
  await browser.close()
})

interface Consumer {
  /** Makes what is served of `scene`, in `folder`; returns the page's head. */
  build: (scene: string, folder: string) => Promise<string>
  /** Folders of the server besides the page's own. */
  served?: Record<string, string>
}

const CONSUMERS: Record<string, Consumer> = {
  Vite: {
    async build(scene, folder) {
      await writeFile(
        join(consumer, 'index.html'),
        `<script type="module" src="${scene}"></script>`,
      )
      await vite({
        configFile: false,
        root: consumer,
        logLevel: 'error',
        build: {
          outDir: folder,
          assetsDir: '.',
          rolldownOptions: { input: join(consumer, scene) },
        },
      })
      return script(await entryOf(folder))
    },
  },
  webpack: {
    async build(scene, folder) {
      const stats = await new Promise<webpack.Stats>((resolve, reject) => {
        webpack(
          {
            mode: 'production',
            context: consumer,
            entry: `./${scene}`,
            // Chunks by import(), not by elements whose addresses trusted types forbid.
            experiments: { outputModule: true },
            output: { path: folder, filename: 'entry.js', publicPath: '/', module: true },
            performance: { hints: false },
          },
          (error, result) => {
            if (error) reject(error)
            else resolve(result!)
          },
        )
      })
      expect(stats.toJson({ all: false, errors: true, warnings: true })).toMatchObject({
        errors: [],
        warnings: [],
      })
      return script('entry.js')
    },
  },
  esbuild: {
    async build(scene, folder) {
      const { warnings } = await esbuild({
        absWorkingDir: consumer,
        entryPoints: { entry: scene },
        outdir: folder,
        bundle: true,
        splitting: true,
        minify: true,
        format: 'esm',
        logLevel: 'silent',
      })
      expect(warnings).toEqual([])
      return script('entry.js')
    },
  },
  'a page with an import map': {
    async build(scene, folder) {
      await cp(join(consumer, scene), join(folder, scene))
      const imports = {
        three: '/three/build/three.module.js',
        'three/addons/': '/three/examples/jsm/',
        'three-diffraction': '/three-diffraction/dist/index.js',
      }
      return `<script type="importmap">${JSON.stringify({ imports })}</script>${script(scene)}`
    },
    served: {
      '/three/': join(root, 'node_modules', 'three'),
      '/three-diffraction/': installed,
    },
  },
}

describe('a scene', () => {
  let first: number[] | null = null

  it.each(Object.keys(CONSUMERS))(
    'is drawn from the tarball by %s, under a strict policy',
    async (name) => {
      const { build, served = {} } = CONSUMERS[name]!
      const folder = join(consumer, 'dist', name.replaceAll(' ', '-'))
      await rm(folder, { recursive: true, force: true })
      await mkdir(folder, { recursive: true })
      await cp(join(root, 'tests/package/consumers/scene.js'), join(consumer, 'scene.js'))
      const head = await build('scene.js', folder)
      const folders = { '/maps/': join(installed, 'maps', 'baked'), ...served, '/': folder }
      const server = await serve(folders, `<!doctype html><meta charset="utf-8">${head}<body>`)
      const page = await browser.newPage()
      const complaints: string[] = []
      page.on('console', (message) => {
        if (['error', 'warning'].includes(message.type())) complaints.push(message.text())
      })
      page.on('pageerror', (error) => complaints.push(String(error)))
      const { port } = server.address() as AddressInfo
      const origin = `http://127.0.0.1:${port}`
      page.on('request', (request) => {
        if (!request.url().startsWith(origin)) complaints.push(request.url())
      })
      try {
        await page.goto(origin)
        await page
          .waitForFunction(() => 'drawn' in window)
          .catch((error: unknown) => {
            throw new Error([String(error), ...complaints].join('\n'))
          })
        const drawn = await page.evaluate<{ pixels: number[]; features: string[]; error?: string }>(
          'window.drawn',
        )
        expect(drawn.error).toBeUndefined()
        expect(drawn.features).toContain('table of the environment for a flat surface')
        // What is not covered is black; what is has colours, and many.
        const colours = new Set<number>()
        for (let i = 0; i < drawn.pixels.length; i += 4)
          colours.add((drawn.pixels[i]! << 16) | (drawn.pixels[i + 1]! << 8) | drawn.pixels[i + 2]!)
        expect(colours.size).toBeGreaterThan(300)
        first ??= drawn.pixels
        expect(drawn.pixels).toEqual(first)
        expect(complaints).toEqual([])
      } finally {
        await page.close()
        server.close()
      }
    },
  )
})

function script(name: string): string {
  return `<script type="module" src="/${name}"></script>`
}

/** The module that a build made of the scene: the one that sets `drawn`. */
async function entryOf(folder: string): Promise<string> {
  for (const file of await readdir(folder))
    if (file.endsWith('.js') && (await readFile(join(folder, file), 'utf8')).includes('drawn'))
      return file
  throw new Error(`No entry in ${folder}`)
}

/** Files of folders by the start of their addresses, and a page, whose inline scripts alone are allowed by their sum. */
async function serve(folders: Record<string, string>, page: string): Promise<Server> {
  const inline = Array.from(
    page.matchAll(/<script type="importmap">(.*?)<\/script>/g),
    ([, text]) => createHash('sha256').update(text!).digest('base64'),
  )
  const scripts = [POLICY['script-src'], ...inline.map((sum) => `'sha256-${sum}'`)].join(' ')
  const policy = Object.entries({ ...POLICY, 'script-src': scripts })
    .map(([name, value]) => `${name} ${value}`)
    .join('; ')
  const server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url!, 'http://host').pathname)
    const respond = (status: number, type: string, body: string | Buffer): void => {
      response.writeHead(status, { 'content-type': type, 'content-security-policy': policy })
      response.end(body)
    }
    if (path === '/') {
      respond(200, 'text/html', page)
      return
    }
    if (path === '/favicon.ico') {
      respond(204, 'image/x-icon', '')
      return
    }
    const [start, folder] = Object.entries(folders).find(([prefix]) => path.startsWith(prefix))!
    const file = join(folder, normalize(path.slice(start.length)))
    readFile(file).then(
      (body) => {
        respond(200, TYPES[extname(file)] ?? 'application/octet-stream', body)
      },
      () => {
        respond(404, 'text/plain', '')
      },
    )
  })
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve))
  return server
}
