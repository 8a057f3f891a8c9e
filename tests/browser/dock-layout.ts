import type { Page } from 'playwright-core'

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
