import { createRequire } from 'node:module'
import type { AxeResults } from 'axe-core'
import type { Page } from 'playwright-core'
import { expect, it } from 'vitest'
import { demoPages, settle, type OpenOptions } from './demo-page'

const axe = createRequire(import.meta.url).resolve('axe-core/axe.min.js')
const { open } = demoPages()

/** What WCAG 2.2 asks for at levels A and AA, as far as a program can tell. */
async function violations(page: Page): Promise<string[]> {
  // Read by the debugger's own way: the page's policy lets no other scripts in.
  const { violations: found } = await page.evaluate(async () => {
    const { axe: checker } = window as unknown as {
      axe: { run: (context: Document, options: object) => Promise<AxeResults> }
    }
    return checker.run(document, {
      runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'],
    })
  })
  return found.flatMap(({ id, nodes }) => nodes.map(({ html }) => `${id}: ${html.slice(0, 120)}`))
}

const LAYOUTS: OpenOptions[] = [
  { width: 360, height: 740, deviceScaleFactor: 0.3 },
  { width: 1440, height: 900, deviceScaleFactor: 0.1 },
]

it.each(LAYOUTS)(
  'contrast, names and targets are as WCAG 2.2 AA asks, $width px wide',
  async (layout) => {
    const { page } = await open('?scene=card&environment=none', {
      ...layout,
      prepare: (blank) => blank.addInitScript({ path: axe }),
    })
    await settle(page)
    expect(await violations(page)).toEqual([])
    await page.evaluate(() => {
      for (const group of document.querySelectorAll('details')) group.open = true
    })
    await page.getByRole('button', { name: 'Compare' }).click()
    await settle(page)
    await page.getByLabel('Foil map', { exact: false }).fill('/nowhere')
    await page.keyboard.press('Enter')
    await page.getByRole('alert').waitFor()
    expect(await violations(page)).toEqual([])
    for (const tool of ['Inspect', 'Design']) {
      await page.getByRole('button', { name: tool }).click()
      await page.locator('#dock details, #dock form').first().waitFor()
      await settle(page)
      expect(await violations(page)).toEqual([])
    }

    // Planted: text that is hardly seen, and a button without a name.
    await page.evaluate(() => {
      document.querySelector<HTMLElement>('#dock p')!.style.color = '#303238'
      document.getElementById('share')!.textContent = ''
    })
    const planted = (await violations(page)).map((text) => text.split(':')[0])
    expect(planted).toContain('color-contrast')
    expect(planted).toContain('button-name')
  },
)

it('everything is reached, and seen to be reached, by the keyboard', async () => {
  const { page } = await open('?scene=card&environment=none', LAYOUTS[1])
  await settle(page)
  const reached = new Set<string>()
  for (let i = 0; i < 80; i++) {
    await page.keyboard.press('Tab')
    const focused = await page.evaluate(() => {
      const element = document.activeElement
      if (!(element instanceof HTMLElement) || element === document.body) return null
      // Radio buttons lie unseen over what is drawn for them.
      const shown = element.matches('.segments input') ? element.nextElementSibling! : element
      const { outlineStyle, outlineWidth } = getComputedStyle(shown)
      return {
        name: element.id || element.textContent || element.tagName,
        isSeen: outlineStyle !== 'none' && parseFloat(outlineWidth) >= 2,
      }
    })
    if (focused === null) break
    expect.soft(focused.isSeen, focused.name).toBe(true)
    reached.add(focused.name)
  }
  for (const id of ['view', 'sway', 'compare', 'share', 'save']) expect(reached).toContain(id)
  expect(reached.size).toBeGreaterThan(20)
})

it('nothing moves by itself where less motion is asked for', async () => {
  const { page } = await open('?scene=card&environment=none', LAYOUTS[0])
  await settle(page)
  expect(await page.getByRole('button', { name: 'Sway' }).getAttribute('aria-pressed')).toBe(
    'false',
  )
  const moving = await page.evaluate(
    () => document.getAnimations().filter(({ playState }) => playState === 'running').length,
  )
  expect(moving).toBe(0)
})
