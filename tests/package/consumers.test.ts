import { createHash } from 'node:crypto'
import { cp, readFile, rm } from 'node:fs/promises'
import { join } from 'node:path'
import type { Browser, Page } from 'playwright-core'
import type { WebGLRenderer } from 'three'
import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import { launchBrowser } from '../../scripts/browser.mjs'
import { runNpm } from '../../scripts/node-packages.mjs'
import { codeBlocks } from '../docs/markdown'
import { consumer, root } from './pack'
import { serveFiles, type Overrides } from './static-server'

declare global {
  interface Window {
    /** Of react-three-fiber's page. */
    renderer: WebGLRenderer
    complain: (text: string) => void
  }
}

const projects = join(consumer, 'consumers')

const STRICTEST = codeBlocks('docs/installing.md').find(({ rule }) => rule === 'policy')!.code

/** The strictest policy that the package's users can set, as we tell them; `inline` lets in the page's import map alone. */
const policy = (inline: string): string =>
  STRICTEST.replaceAll('\n', ' ').replace("script-src 'self'", `$&${inline}`)

/** Under that policy. */
function guarded(html: string): Record<string, string> {
  const map = /<script type="importmap">([^]*?)<\/script>/.exec(html)?.[1]
  const hash = map === undefined ? '' : ` 'sha256-${digest('sha256', map)}'`
  return { 'content-security-policy': policy(hash) }
}

function digest(algorithm: string, content: string | Buffer): string {
  return createHash(algorithm).update(content).digest('base64')
}

let browser: Browser
/** The picture of the page without a bundler. */
let expected: Picture

beforeAll(async () => {
  await rm(projects, { recursive: true, force: true })
  await cp(join(import.meta.dirname, 'consumers'), projects, { recursive: true })
  browser = await launchBrowser({ backend: 'llvmpipe' })
  expected = await visit(unbundled, 'plain/')
})

afterAll(async () => {
  await browser.close()
})

/** react-three-fiber 9 has a clock that three has deprecated. */
const NOT_OURS = /THREE\.Clock/

/** Folders that a page without a bundler is served from, each of them with node_modules/. */
const unbundled = [projects, consumer, root]

interface Picture {
  width: number
  height: number
  /** RGBA, 8 bits. */
  pixels: number[]
}

/**
 * Opens a page under the policy, and reads its canvas once it has drawn. Fails where the page breaks the policy, writes
 * warnings or errors, or asks another origin for anything.
 *
 * @param folders - that hold the page, and what it imports
 * @param use - what is done with the page then
 */
async function visit(
  folders: string[],
  path = '',
  { overrides = {}, use }: { overrides?: Overrides; use?: (page: Page) => Promise<void> } = {},
): Promise<Picture> {
  const server = await serveFiles(folders, guarded, overrides)
  const page = await browser.newPage()
  const complaints: string[] = []
  let fail!: (error: Error) => void
  const failure = new Promise<never>((_, reject) => {
    fail = reject
  })
  const complain = (text: string): void => {
    complaints.push(text)
    fail(new Error(text))
  }
  try {
    page.on('console', (message) => {
      const isWanted = ['error', 'warning'].includes(message.type())
      if (isWanted && !NOT_OURS.test(message.text())) complain(message.text())
    })
    page.on('pageerror', (error) => {
      complain(String(error))
    })
    page.on('response', (response) => {
      if (!response.ok()) complain(`${response.status()} ${response.url()}`)
    })
    page.on('request', (request) => {
      if (!request.url().startsWith(server.url)) complain(`asks for ${request.url()}`)
    })
    await page.exposeFunction('complain', complain)
    await page.addInitScript(() => {
      document.addEventListener('securitypolicyviolation', (event) => {
        window.complain(`${event.violatedDirective}: ${event.blockedURI} ${event.sample}`)
      })
    })
    const draw = async (): Promise<Picture> => {
      await page.goto(server.url + path)
      await page.waitForFunction(() => document.title === 'drawn')
      const picture = await page.evaluate(readCanvas)
      await use?.(page)
      return picture
    }
    const picture = await Promise.race([failure, draw()])
    expect(complaints).toEqual([])
    return picture
  } finally {
    await page.close()
    await server.close()
  }
}

function readCanvas(): Picture {
  const gl = document.querySelector('canvas')!.getContext('webgl2')!
  const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight]
  const pixels = new Uint8Array(4 * width * height)
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels)
  return { width, height, pixels: [...pixels] }
}

function blueOf({ pixels }: Picture): number {
  return pixels.reduce((sum, value, i) => (i % 4 === 2 ? sum + value : sum), 0)
}

async function build(name: string): Promise<string> {
  const project = join(projects, name)
  await runNpm(`Building for ${name}`, ['run', 'build', '--prefix', project])
  return project
}

/** Compilers may reorder sums: a step of 8 bits. */
function expectSame({ width, height, pixels }: Picture): void {
  expect([width, height]).toEqual([expected.width, expected.height])
  const steps = pixels.map((value, i) => Math.abs(value - expected.pixels[i]!))
  expect(steps.filter((step) => step > 1)).toEqual([])
}

it('draws colours of its own without a bundler', () => {
  const { width, height, pixels } = expected
  const colours = Array.from({ length: width * height }, (_, i) => pixels.slice(4 * i, 4 * i + 3))
  const vivid = colours.filter((colour) => Math.max(...colour) - Math.min(...colour) > 60)
  expect(vivid.length).toBeGreaterThan(0.05 * colours.length)
  // Red, green and blue each lead somewhere.
  const leaders = new Set(vivid.map((colour) => colour.indexOf(Math.max(...colour))))
  expect([...leaders].sort()).toEqual([0, 1, 2])
})

it.each(['vite', 'webpack', 'esbuild'])('draws the same built by %s', async (name) => {
  expectSame(await visit([join(await build(name), 'dist')]))
})

describe('modules that are pinned', () => {
  it('draw the same', async () => {
    await build('plain')
    expectSame(await visit(unbundled, 'plain/pinned.html'))
  })

  it.each(['index', 'maps/load', 'maps/png'])('are refused where %s differs', async (name) => {
    const path = `/node_modules/three-diffraction/dist/${name}.js`
    const content = await readFile(join(consumer, path), 'utf8')
    const overrides = { [path]: `${content}\n` }
    const visited = visit(unbundled, 'plain/pinned.html', { overrides })
    await expect(visited).rejects.toThrow(/integrity/)
  })
})

it('draws the same with the version of three before', async () => {
  const html = await readFile(join(projects, 'plain/index.html'), 'utf8')
  const overrides = { '/plain/index.html': html.replaceAll('/three/', '/three-previous/') }
  expectSame(await visit(unbundled, 'plain/', { overrides }))
})

it('draws the same as an element of react-three-fiber, takes its props, and goes with it', async () => {
  const folder = join(await build('react-three-fiber'), 'dist')
  const use = async (page: Page): Promise<void> => {
    const next = page.getByRole('button', { name: 'Next' })
    await next.click()
    const gold = blueOf(expected)
    await expect
      .poll(async () => blueOf(await page.evaluate(readCanvas)))
      .toBeGreaterThan(1.1 * gold)
    await next.click()
    await page.waitForFunction(() => {
      const { memory, programs } = window.renderer.info
      return memory.textures === 0 && memory.geometries === 0 && programs!.length === 0
    })
  }
  expectSame(await visit([folder], '', { use }))
})
