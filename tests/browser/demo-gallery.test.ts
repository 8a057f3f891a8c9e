import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs'
import { join } from 'node:path'
import type { Page } from 'playwright-core'
import { describe, expect, it } from 'vitest'
import { demoPages, screenshotOf, settle, stirred, type OpenOptions } from './demo-page'
import { meanDifference, pixelsOf, pngOf, type Pixels } from './screenshot'

/**
 * What the gallery looked like when somebody last looked: `UPDATE_PICTURES=1` writes these files anew. They keep what looks
 * right from changing unseen; that it is right, the comparison with the reference says elsewhere.
 */
const PICTURES = join(import.meta.dirname, 'gallery')
const MAY_WRITE = process.env['UPDATE_PICTURES'] === '1'

/** Pixels of their width: enough to see an object turned, mirrored, unlit or gone. */
const WIDTH = 120
/** Mean difference of all channels, of 255, that another build of the same rasteriser may make. */
const TOLERANCE = 1.5

const SUBJECTS = ['card', 'bag', 'note', 'bottle', 'disc', 'vase', 'snake', 'wafer']

/** Layouts of a telephone and of a desk; drawn with fewer pixels than they have there, for software draws slowly. */
const LAYOUTS: OpenOptions[] = [
  { width: 360, height: 740, deviceScaleFactor: 0.4 },
  { width: 1440, height: 800, deviceScaleFactor: 0.2 },
]

const { open } = demoPages()

// One page for all of them, for each of its own takes longer to load than to draw.
it.each(LAYOUTS)('the gallery shows everything, $width px wide', async (layout) => {
  const { page, complaints, elsewhere } = await open('', { ...layout, prepare: watchShifts })
  await settle(page)
  expect(await shiftsOf(page)).toBe(0)
  const names = await page.locator('#subjects label').allInnerTexts()
  expect(names.map((name) => name.toLowerCase())).toEqual(SUBJECTS)
  for (const name of SUBJECTS) {
    const tab = page.locator(`#subjects input[value=${name}]`)
    if (!(await tab.isChecked())) {
      await tab.check()
      await stirred(page)
      await settle(page)
    }
    expect.soft(await page.locator('#banner').isVisible(), name).toBe(false)
    const width = await page.evaluate(() => document.documentElement.scrollWidth)
    expect.soft(width, name).toBe(layout.width)
    await expectPicture(page, `${name}-${String(layout.width)}`, await screenshotOf(page))
  }
  expect(complaints).toEqual([])
  expect(elsewhere).toEqual([])
})

describe('the comparison of pictures', () => {
  it('notices an object that is mirrored', async () => {
    const { page } = await open('?scene=card', LAYOUTS[1])
    await settle(page)
    const pixels = await stored(page, 'card-1440')
    const mirrored = pixels.map((_, i) => pixels[mirror(i)]!)
    expect(meanDifference(pixels, mirrored)).toBeGreaterThan(2 * TOLERANCE)
  })
})

async function expectPicture(page: Page, name: string, seen: Buffer): Promise<void> {
  const path = join(PICTURES, `${name}.png`)
  if (MAY_WRITE) {
    mkdirSync(PICTURES, { recursive: true })
    writeFileSync(path, await pngOf(page, seen, WIDTH))
  }
  const difference = meanDifference(await stored(page, name), await pixelsOf(page, seen, WIDTH))
  expect.soft(difference, name).toBeLessThan(TOLERANCE)
}

async function stored(page: Page, name: string): Promise<Pixels> {
  const path = join(PICTURES, `${name}.png`)
  if (!existsSync(path)) throw new Error(`${path} is missing: UPDATE_PICTURES=1 writes it`)
  return pixelsOf(page, readFileSync(path), WIDTH)
}

/** Index of the same channel on the other side of the picture. */
function mirror(index: number): number {
  const column = Math.floor(index / 4) % WIDTH
  return index + 4 * (WIDTH - 1 - 2 * column)
}

/** Adds up by how much of the window what is there already moves while the page loads. */
async function watchShifts(page: Page): Promise<void> {
  await page.addInitScript(() => {
    const shown = window as { shifts?: number }
    shown.shifts = 0
    new PerformanceObserver((list) => {
      for (const entry of list.getEntries())
        shown.shifts! += (entry as PerformanceEntry & { value: number }).value
    }).observe({ type: 'layout-shift', buffered: true })
  })
}

function shiftsOf(page: Page): Promise<number> {
  return page.evaluate(() => (window as { shifts?: number }).shifts ?? NaN)
}
