import type { Page } from 'playwright-core'
import { describe, expect, it } from 'vitest'
import { gamutMapped } from '../../demo/inspector/optics/display'
import { demoPages, settle, type OpenedPage } from './demo-page'
import { dockLayout } from './dock-layout'

const { open } = demoPages()

/** Opens the page and its inspector, by the keyboard. */
async function inspect(query: string, width: number, height: number): Promise<OpenedPage> {
  const opened = await open(query, { width, height })
  await settle(opened.page)
  await opened.page.getByRole('button', { name: 'Inspect', exact: true }).press('Enter')
  await opened.page.waitForSelector('.point-facts dd')
  return opened
}

/** What the facts say of a term. */
function fact(page: Page, term: string): Promise<string> {
  return page
    .locator('.point-facts div')
    .filter({ has: page.locator('dt', { hasText: term }) })
    .locator('dd')
    .innerText()
}

/** As soon as the page has followed. */
function soon<T>(read: () => Promise<T>): ReturnType<typeof expect.poll<T>> {
  return expect.poll(read, { timeout: 60_000 })
}

/** Linear sRGB of a swatch, once it is there. */
async function swatch(page: Page, label: string): Promise<number[]> {
  const found = page.locator('.swatch[data-rgb]').filter({ hasText: label })
  await found.waitFor()
  const text = await found.getAttribute('data-rgb')
  return text!.split(' ').map(Number)
}

/** A picture's text alternative. */
function alternative(page: Page, title: string): Promise<string> {
  return page
    .locator('.block')
    .filter({ has: page.locator('summary', { hasText: new RegExp(title) }) })
    .locator('figcaption')
    .innerText()
}

describe('the inspector', () => {
  it('is not loaded before it is opened', async () => {
    const { page } = await open()
    await settle(page)
    const loaded = (): Promise<string[]> =>
      page.evaluate(() =>
        performance
          .getEntriesByType('resource')
          .map(({ name }) => name)
          .filter((name) => /contents/.test(name)),
      )
    expect(await loaded()).toEqual([])
    await page.getByRole('button', { name: 'Inspect', exact: true }).click()
    await page.waitForSelector('.point-facts dd')
    expect(await loaded()).not.toEqual([])
  })

  it('computes from the spectrum the colour that the shader gives the flash', async () => {
    const { page, complaints } = await inspect('?scene=vase', 820, 420)
    // Alone: colours are moved into the display's gamut as they add up.
    await page.keyboard.press('Escape')
    await page.getByLabel('Environment', { exact: true }).selectOption('none')
    await page.getByLabel('Angular radius (σ)', { exact: true }).press('End')
    await settle(page)
    await page.getByRole('button', { name: 'Inspect', exact: true }).click()
    await page.getByLabel('Inspected point', { exact: false }).focus()
    // Up the vase to where the flash lights it.
    const lit: [rendered: number[], computed: number[]][] = []
    for (const key of ['Shift+ArrowUp', ...Array.from({ length: 12 }, () => 'ArrowLeft')]) {
      await page.keyboard.press(key)
      await page.waitForTimeout(300)
      const rendered = await swatch(page, 'Flash, as rendered')
      if (Math.max(...rendered) < 0.01) continue
      const computed = (await swatch(page, 'Flash, by its spectrum')) as [number, number, number]
      lit.push([rendered, gamutMapped(computed)])
    }
    expect(lit.length).toBeGreaterThan(1)
    for (const [rendered, computed] of lit)
      for (const [c, value] of rendered.entries())
        expect(Math.abs(value - computed[c]!)).toBeLessThan(0.05 * Math.max(...rendered))
    expect(complaints).toEqual([])
  })

  it('follows the crosshair, the map and the flash', async () => {
    const { page, complaints } = await inspect('', 1280, 600)
    const texel = await fact(page, 'Texel')
    await page.getByLabel('Inspected point', { exact: false }).press('Shift+ArrowRight')
    await soon(() => fact(page, 'Texel')).not.toBe(texel)
    const [column, row] = (await fact(page, 'Texel')).match(/\d+/g)!.map(Number)
    await page.locator('.orientation').press('ArrowDown')
    await soon(() => fact(page, 'Texel')).toBe(`column ${column}, row ${(row! + 1) % 256}`)
    expect(await alternative(page, 'Orientation')).toContain(`column ${column}`)
    const lobes = await alternative(page, '^Lobes')
    await page.getByLabel('Azimuth', { exact: true }).press('Home')
    await soon(() => alternative(page, '^Lobes')).not.toBe(lobes)
    // A tap on the view picks, a drag does not.
    const before = await fact(page, 'Texel')
    const view = (await page.locator('#view').boundingBox())!
    await page.mouse.click(view.x + 0.4 * view.width, view.y + 0.45 * view.height)
    await soon(() => fact(page, 'Texel')).not.toBe(before)
    expect(complaints).toEqual([])
  })

  it('shows each kind of surface what it is made of', async () => {
    const { page, complaints } = await inspect('?scene=wafer', 820, 420)
    expect(await alternative(page, 'Spectrum of the relief')).toMatch(/Strongest.*%/)
    expect(await page.locator('.block', { hasText: /^Lobes/ }).isVisible()).toBe(false)
    for (const table of ['series', 'colours', 'metals']) {
      await page.locator('summary', { hasText: table }).press('Enter')
      await soon(() => alternative(page, table)).toMatch(/\d/)
    }
    await page.getByLabel('Vase', { exact: true }).check()
    await settle(page)
    await soon(() => fact(page, 'Period')).toContain('1.20')
    expect(await alternative(page, 'Arcs in the environment')).toMatch(/\+1 from/)
    expect(await alternative(page, '^Lobes')).toMatch(/0: \d+\.\d/)
    expect(complaints).toEqual([])
  })

  it('fits a phone, and leaves by Escape', async () => {
    const { page } = await inspect('?scene=disc', 360, 740)
    await page.evaluate(() => {
      for (const block of document.querySelectorAll<HTMLDetailsElement>('.block')) block.open = true
    })
    await page.waitForTimeout(1000)
    const { over, small } = await dockLayout(page)
    expect(over).toBeLessThanOrEqual(0)
    expect(small).toEqual([])
    await page.locator('.dock summary').first().focus()
    await page.keyboard.press('Escape')
    expect(await page.locator('#dock').isVisible()).toBe(false)
    expect(await page.evaluate(() => document.activeElement?.id)).toBe('inspect')
    expect(await page.locator('.crosshair').count()).toBe(0)
  })
})
