import type { Browser, BrowserContextOptions, Page } from 'playwright-core'
import { afterAll, afterEach, beforeAll } from 'vitest'
import { launchBrowser, serveDemo } from '../../scripts/browser.mjs'
import { pixelsOf, type Pixels } from './screenshot'

/** For the slowest object on a machine that does other things too, ms. */
export const SETTLED_MS = 120_000

export interface OpenedPage {
  page: Page
  /** What the page wrote as errors and warnings so far. */
  complaints: string[]
  /** Addresses that it asked for on other hosts. */
  elsewhere: string[]
}

export interface OpenOptions extends BrowserContextOptions {
  /** The view of the page, CSS pixels. */
  width?: number
  height?: number
  /** Whether the page may keep itself for times without a network: all its files are fetched then. */
  isKept?: boolean
  /** Called before the page is opened. */
  prepare?: (page: Page) => Promise<unknown>
}

/** Serves the built demo page to the tests of a file. */
export function demoPages(): {
  open: (query?: string, options?: OpenOptions) => Promise<OpenedPage>
} {
  let server: Awaited<ReturnType<typeof serveDemo>>
  let browser: Browser
  const opened: Page[] = []

  beforeAll(async () => {
    server = await serveDemo()
    browser = await launchBrowser({ backend: 'llvmpipe' })
  })
  afterEach(async () => {
    for (const page of opened.splice(0)) await page.context().close()
  })
  afterAll(async () => {
    await browser.close()
    await server.close()
  })

  const open = async (query = '', options: OpenOptions = {}): Promise<OpenedPage> => {
    const { width = 480, height = 400, isKept = false, prepare, ...others } = options
    const context = await browser.newContext({
      viewport: { width, height },
      reducedMotion: 'reduce',
      // A quarter of the pixels: software draws slowly.
      deviceScaleFactor: 0.5,
      ...others,
    })
    const page = await context.newPage()
    opened.push(page)
    page.setDefaultTimeout(SETTLED_MS)
    const complaints: string[] = []
    const elsewhere: string[] = []
    page.on('console', (message) => {
      if (['error', 'warning'].includes(message.type())) complaints.push(message.text())
    })
    page.on('pageerror', (error) => complaints.push(String(error)))
    page.on('request', (request) => {
      const url = request.url()
      if (!/^(data|blob):/.test(url) && !url.startsWith(server.url)) elsewhere.push(url)
    })
    if (!isKept)
      await page.addInitScript(() => Reflect.deleteProperty(Navigator.prototype, 'serviceWorker'))
    await prepare?.(page)
    // Two frames in place of sixteen: finer ones show nothing else.
    const parameters = new URLSearchParams(query)
    if (!parameters.has('frames')) parameters.set('frames', '2')
    // Measuring takes seconds of a machine that has other tests to run.
    if (!parameters.has('error')) parameters.set('error', 'report')
    await page.goto(`${server.url}?${parameters.toString()}`)
    return { page, complaints, elsewhere }
  }
  return { open }
}

/** Waits until nothing is being loaded and the picture is finished. */
export async function settle(page: Page): Promise<void> {
  await page.waitForSelector('#controls label', { state: 'attached' })
  await page.waitForSelector('#loading', { state: 'hidden' })
  await page.waitForSelector('#view[data-state=settled]')
  seen.set(page, await finished(page))
}

/** Which picture was the last that `settle` waited for: the number that the page gave it. */
const seen = new WeakMap<Page, string | null>()

function finished(page: Page): Promise<string | null> {
  return page.locator('#view').getAttribute('data-pictures')
}

/** The finished picture. */
export async function picture(page: Page): Promise<Pixels> {
  return pixelsOf(page, await screenshotOf(page))
}

/**
 * The finished picture as a PNG file, without what stands before it: buttons cover a part of it, facts tell times that
 * differ from run to run, and letters are those of the machine's fonts.
 */
export async function screenshotOf(page: Page): Promise<Buffer> {
  await settle(page)
  await hideWhatIsBefore(page, true)
  const png = await page.locator('#view').screenshot()
  await hideWhatIsBefore(page, false)
  return png
}

async function hideWhatIsBefore(page: Page, areHidden: boolean): Promise<void> {
  await page.evaluate((hidden) => {
    // What has the focus has a frame.
    ;(document.activeElement as HTMLElement | null)?.blur()
    for (const part of document.querySelectorAll<HTMLElement>('.stage-top, .stage-bottom'))
      part.style.visibility = hidden ? 'hidden' : ''
  }, areHidden)
}

/** Waits until a change has reached the picture: until there is another one than `settle` waited for. */
export async function stirred(page: Page): Promise<void> {
  await page.waitForFunction(
    (number) => document.getElementById('view')?.dataset['pictures'] !== number,
    seen.get(page) ?? undefined,
  )
}
