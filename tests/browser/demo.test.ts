import type { Page } from 'playwright-core'
import { describe, expect, it } from 'vitest'
import { demoPages, picture, settle, stirred } from './demo-page'
import { meanDifference, shareOf, type Pixels } from './screenshot'

const { open } = demoPages()

/** Presses keys on the control of that label, found and reached as from the keyboard. */
async function press(page: Page, label: string, ...keys: string[]): Promise<void> {
  const control = page.getByLabel(label, { exact: true })
  await control.focus()
  for (const key of keys) await page.keyboard.press(key)
  await stirred(page)
}

function isBright(r: number, g: number, b: number): boolean {
  return Math.max(r, g, b) > 64
}

/**
 * Red, green and blue, each well above the other two, each on a share of the view: what a white environment shows only by
 * diffraction.
 */
function expectColours(pixels: Pixels, share: number): void {
  const dominates = (a: number, b: number, c: number): boolean => a > 80 && a > 1.5 * Math.max(b, c)
  expect(shareOf(pixels, (r, g, b) => dominates(r, g, b))).toBeGreaterThan(share)
  expect(shareOf(pixels, (r, g, b) => dominates(g, r, b))).toBeGreaterThan(share)
  expect(shareOf(pixels, (r, g, b) => dominates(b, r, g))).toBeGreaterThan(share)
}

// Changes are means over all pixels, of 255; a picture that is drawn twice differs by less than 0.1.
describe('the demo', () => {
  it('loads without complaints and shows colours', async () => {
    const { page, complaints } = await open()
    const pixels = await picture(page)
    expect(complaints).toEqual([])
    expect(await page.locator('#banner').isVisible()).toBe(false)
    expect(shareOf(pixels, isBright)).toBeGreaterThan(0.1)
    expectColours(pixels, 0.002)
  })

  it('shows a snake in colours', async () => {
    const { page, complaints } = await open('?scene=snake', {
      ...{ width: 420, height: 300 },
      deviceScaleFactor: 1,
    })
    const pixels = await picture(page)
    expect(complaints).toEqual([])
    // It is narrow, and dark between its colours.
    expectColours(pixels, 0.0003)
  })

  it('shows a wafer in colours, and another relief when it is chosen', async () => {
    const { page, complaints } = await open('?scene=wafer', { width: 820, height: 240 })
    const before = await picture(page)
    expectColours(before, 0.001)
    expect(await page.getByLabel('Method', { exact: true }).inputValue()).toBe('line-sum')
    await page.getByLabel('Relief', { exact: true }).selectOption('cosine')
    await stirred(page)
    expect(meanDifference(before, await picture(page))).toBeGreaterThan(0.3)
    expect(await page.getByLabel('Period', { exact: true }).isVisible()).toBe(false)
    expect(await page.locator('#banner').isVisible()).toBe(false)
    expect(complaints).toEqual([])
  })

  it('covers the card with the other foil', async () => {
    const { page, complaints } = await open('', { width: 820, height: 240 })
    const before = await picture(page)
    const foil = page.getByLabel('Pattern', { exact: true })
    expect(await foil.inputValue()).toBe('/maps/baked/foil-polygons')
    await foil.selectOption('Glitter')
    await stirred(page)
    const glitter = await picture(page)
    expectColours(glitter, 0.001)
    expect(meanDifference(before, glitter)).toBeGreaterThan(0.3)
    expect(await foil.inputValue()).toBe('/maps/baked/foil-glitter')
    expect(await page.locator('#banner').isVisible()).toBe(false)
    expect(complaints).toEqual([])
  })

  it('obeys the keyboard', async () => {
    const { page, complaints } = await open('?scene=disc', { width: 820, height: 240 })
    await page.locator('summary', { hasText: 'Light and method' }).press('Enter')
    let before = await picture(page)
    const changed = async (): Promise<number> => {
      const after = await picture(page)
      const difference = meanDifference(before, after)
      before = after
      return difference
    }
    await press(page, 'Period', 'Home')
    expect(await changed()).toBeGreaterThan(0.3)
    await press(page, 'Illuminant', 'ArrowDown')
    expect(await page.getByLabel('Illuminant').inputValue()).toBe('A')
    expect(await changed()).toBeGreaterThan(0.3)
    await press(page, 'Method', 'ArrowDown')
    expect(await page.getByLabel('Method', { exact: true }).inputValue()).toBe('wavelength-loop')
    expect(await changed()).toBeGreaterThan(0.3)
    await press(page, 'Three-dimensional view', 'ArrowRight', 'ArrowRight')
    expect(await changed()).toBeGreaterThan(0.3)
    expect(complaints).toEqual([])
  })

  it('fits a phone', async () => {
    const { page } = await open('', { width: 360, height: 740 })
    await settle(page)
    const sheet = page.locator('#sheet')
    expect(await sheet.getAttribute('open')).toBeNull()
    await sheet.locator('> summary').click()
    await page.locator('summary', { hasText: 'Light and method' }).click()
    for (const label of ['Environment', 'Roughness (σ of tilt)', 'Coherence (σ of window)']) {
      const control = page.getByLabel(label, { exact: true })
      await control.scrollIntoViewIfNeeded()
      // A trial click fails where something covers the control or it lies outside the window.
      await control.click({ trial: true })
    }
    const widths = await page.evaluate(() => [
      document.documentElement.scrollWidth,
      document.querySelector('.panel')!.scrollWidth - document.querySelector('.panel')!.clientWidth,
    ])
    expect(widths).toEqual([360, 0])
    const view = (await page.locator('#view').boundingBox())!
    expect(view.height).toBeGreaterThan(300)
    expect(shareOf(await picture(page), isBright)).toBeGreaterThan(0.05)
  })

  it('says what is wrong with a map, and keeps the last good foil', async () => {
    const { page } = await open('', { width: 820, height: 240 })
    const before = await picture(page)
    await page.getByLabel('Foil map', { exact: false }).fill('/maps/baked/metals')
    await page.keyboard.press('Enter')
    const banner = page.getByRole('alert')
    await banner.waitFor()
    expect(await banner.innerText()).toContain('/maps/baked/metals.json: kind')
    await page.getByRole('button', { name: 'Close this message' }).click()
    const after = await picture(page)
    expect(meanDifference(before, after)).toBeLessThan(0.1)
  })

  it('says where there is no such map, when it is opened with one', async () => {
    const { page } = await open('?foil=/maps/baked/nothing')
    const banner = page.getByRole('alert')
    await banner.waitFor()
    expect(await banner.innerText()).toContain('/maps/baked/nothing.json: file is "HTTP 404"')
    expect(shareOf(await picture(page), isBright)).toBeGreaterThan(0.05)
  })

  it('says what the browser lacks', async () => {
    const { page } = await open('', {
      prepare: (blank) =>
        blank.addInitScript(() => {
          HTMLCanvasElement.prototype.getContext = () => null
        }),
    })
    const message = page.getByRole('alert')
    await message.waitFor()
    expect(await message.innerText()).toContain('WebGL 2')
    expect(await page.locator('#view').isVisible()).toBe(false)
  })
})
