import type { Browser, Page } from 'playwright-core'

/** For the slowest foil on a machine that does other things too, ms. */
export const SETTLED_MS = 120_000

export interface OpenedPage {
  page: Page
  /** What the page wrote as errors and warnings so far. */
  complaints: string[]
}

/** Opens the demo page. address: with its query. */
export async function openPage(
  browser: Browser,
  address: string,
  width: number,
  height: number,
): Promise<OpenedPage> {
  const page = await browser.newPage({
    viewport: { width, height },
    reducedMotion: 'reduce',
    acceptDownloads: true,
  })
  page.setDefaultTimeout(SETTLED_MS)
  const complaints: string[] = []
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type())) complaints.push(message.text())
  })
  page.on('pageerror', (error) => complaints.push(String(error)))
  await page.goto(address)
  return { page, complaints }
}

/** Waits until nothing is being loaded and the picture is finished. */
export async function settle(page: Page): Promise<void> {
  await page.waitForSelector('#controls label', { state: 'attached' })
  await page.waitForSelector('#loading', { state: 'hidden' })
  await page.waitForSelector('#view[data-state=settled]')
}

/** How far an open tool's contents, or the page, stick out of their width, CSS pixels; and what of it is too small to be hit. */
export function dockLayout(page: Page): Promise<{ over: number; small: string[] }> {
  return page.evaluate(() => {
    const body = document.querySelector('.dock-body')!
    const right = body.getBoundingClientRect().right
    const over = [...body.querySelectorAll('*')]
      .filter((element) => !element.closest('svg > *'))
      .map((element) => element.getBoundingClientRect())
      .filter(({ width }) => width > 1)
      .map((box) => box.right - right)
    const targets = document.querySelectorAll(
      '.dock button, .dock select, .dock input, .dock summary, .crosshair',
    )
    const small = [...targets]
      .map((target) => ({ target, box: target.getBoundingClientRect() }))
      .filter(({ box }) => box.width > 0 && (box.width < 24 || box.height < 24))
      .map(({ target, box }) => `${target.outerHTML.slice(0, 60)} ${box.width} × ${box.height}`)
    return { over: Math.max(document.documentElement.scrollWidth - innerWidth, ...over), small }
  })
}
