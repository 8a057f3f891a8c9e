import { execFile } from 'node:child_process'
import { mkdir, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises'
import { join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { promisify } from 'node:util'
import { unzipSync } from 'fflate'
import type { Page } from 'playwright-core'
import ts from 'typescript'
import { afterAll, afterEach, beforeAll, describe, expect, it, vi } from 'vitest'
import { venvProgram } from '../../scripts/python.mjs'
import { Foil } from '../../web'
import { serveFiles } from '../web/fake-maps'
import { python } from '../web/python'
import { demoPages, picture, settle, type OpenedPage, type OpenOptions } from './demo-page'
import { dockLayout } from './dock-layout'
import { meanDifference } from './screenshot'

const root = fileURLToPath(new URL('../../', import.meta.url))

const { open } = demoPages()
let folder: string

beforeAll(async () => {
  await mkdir(join(root, 'tests/output'), { recursive: true })
  folder = await mkdtemp(join(root, 'tests/output/demo-design-'))
})

afterEach(() => {
  vi.unstubAllGlobals()
})

afterAll(async () => {
  await rm(folder, { recursive: true })
})

/** Under a flash alone pages draw several times as fast. */
async function design(
  query: string,
  width: number,
  height: number,
  options: OpenOptions = {},
): Promise<OpenedPage> {
  const opened = await open(query, { width, height, acceptDownloads: true, ...options })
  await settle(opened.page)
  await opened.page.getByRole('button', { name: 'Design', exact: true }).press('Enter')
  await opened.page.waitForSelector('.design')
  return opened
}

/** Few large polygons: the fewer gratings, the sooner they are drawn. */
async function makePolygons(page: Page): Promise<void> {
  await page.getByLabel('Shapes', { exact: true }).selectOption('polygons')
  await page.getByLabel('Size of a shape', { exact: true }).fill('6')
  await page.getByLabel('Texels a side', { exact: true }).fill('64')
  await page.getByRole('button', { name: 'Make the foil' }).press('Enter')
  await page.locator('.design [role=status]', { hasText: '64 × 64 texels' }).waitFor()
}

/** Saves the map by the page's own button; its files by name, which lie in the folder too. */
async function savedFiles(page: Page): Promise<Record<string, Uint8Array>> {
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('button', { name: 'Download' }).press('Enter'),
  ])
  const files = unzipSync(new Uint8Array(await readFile(await download.path())))
  for (const [name, bytes] of Object.entries(files)) await writeFile(join(folder, name), bytes)
  return files
}

/** What the fields of the form in view hold, by their names. */
function fieldsOf(page: Page): Promise<Record<string, string>> {
  return page.evaluate(() =>
    Object.fromEntries(
      [...document.querySelectorAll<HTMLInputElement>('.form [name]')]
        .filter((field) => field.checkVisibility())
        .map(({ name, value }) => [name, value]),
    ),
  )
}

async function inspected(name: string): Promise<string> {
  const program = join(root, venvProgram('diffraction'))
  return (await promisify(execFile)(program, ['inspect', join(folder, `${name}.json`)])).stdout
}

/** What TypeScript says of code that imports the package. */
function typeErrors(file: string): string[] {
  const program = ts.createProgram([file, join(root, 'web/glsl.d.ts')], {
    ...{ module: ts.ModuleKind.ESNext, moduleResolution: ts.ModuleResolutionKind.Bundler },
    ...{ target: ts.ScriptTarget.ES2022, strict: true, noEmit: true, skipLibCheck: true },
    ...{ allowImportingTsExtensions: true, types: ['vite/client'] },
    paths: { 'three-diffraction': [join(root, 'web/index.ts')] },
  })
  return [...program.getSyntacticDiagnostics(), ...program.getSemanticDiagnostics()].map(
    ({ messageText }) => ts.flattenDiagnosticMessageText(messageText, '\n'),
  )
}

describe('the design panel', () => {
  it('shows a foil of strewn shapes, and saves a map that the command and the library read', async () => {
    const { page, complaints } = await design('?environment=none', 820, 420)
    const before = await picture(page)
    await makePolygons(page)
    expect(meanDifference(before, await picture(page))).toBeGreaterThan(0.3)
    await page.getByLabel('Name of the map').fill('strewn_1')
    const files = await savedFiles(page)
    expect(Object.keys(files).sort()).toEqual(['strewn_1.grating.png', 'strewn_1.json'])
    expect(await inspected('strewn_1')).toMatch(/checksums\s+match/)
    serveFiles(
      Object.fromEntries(Object.entries(files).map(([name, data]) => [`maps/${name}`, data])),
    )
    const foil = await Foil.load('maps/strewn_1')
    expect(foil.map.sidecar.recipe).toMatchObject({
      design: 'stochastic',
      shape: 'polygons',
      seed: 1,
    })
    expect(foil.tile).toEqual([25, 25])
    expect(complaints).toEqual([])
  })

  it('gives the foil on show periods by orientation, with code that compiles', async () => {
    const { page, complaints } = await design('?environment=none', 820, 420)
    const before = await picture(page)
    await page.getByLabel('Periods by orientation').check()
    await page.getByLabel('Period at 0°').fill('0.9')
    await page
      .locator('.design [role=status]', { hasText: '900' })
      .or(page.locator('.design [role=status]', { hasText: '0.900' }))
      .waitFor()
    expect(meanDifference(before, await picture(page))).toBeGreaterThan(0.3)
    // The last values of the edit alone are told.
    await page.getByLabel('From first to last').selectOption('sin2')
    await page.waitForTimeout(1000)
    await page.locator('.design [role=status]', { hasText: 'On show' }).waitFor()
    await savedFiles(page)
    expect(await inspected('my-foil')).toMatch(/checksums\s+match/)
    const sidecar = JSON.parse(await readFile(join(folder, 'my-foil.json'), 'utf8')) as {
      recipe: unknown
    }
    expect(sidecar.recipe).toMatchObject({
      design: 'edited',
      from: { map: 'foil-polygons' },
      edits: [{ kind: 'period', shortest: 0.9, longest: 2, bins: 12, blend: 'sin2' }],
    })
    const code = await page.locator('.design code').innerText()
    expect(code).toContain("Foil.load('/maps/my-foil'")
    const file = join(folder, 'snippet.ts')
    await writeFile(file, code)
    expect(typeErrors(file)).toEqual([])
    await writeFile(file, code.replace('metal:', 'metall:'))
    expect(typeErrors(file)).not.toEqual([])
    expect(complaints).toEqual([])
  })

  it('says beside a field what is wrong with it, and keeps the last good foil', async () => {
    const { page } = await design('?environment=none', 820, 420)
    await makePolygons(page)
    const before = await picture(page)
    const refused = async (label: string, text: string, expected: RegExp): Promise<void> => {
      const field = page.locator('.design').getByLabel(label, { exact: true })
      const good = await field.inputValue()
      await field.fill(text)
      await page
        .locator('.field', { has: page.getByLabel(label, { exact: true }) })
        .locator('.field-error', { hasText: expected })
        .waitFor()
      expect(await field.getAttribute('aria-invalid')).toBe('true')
      await field.fill(good)
      await page.locator('.design [role=status]', { hasText: 'On show' }).waitFor()
      expect(await field.getAttribute('aria-invalid')).toBe('false')
    }
    await refused('Longest period', '1', /above the shortest, 1.2 µm/)
    await refused('Size of a shape', '20', /two texels to half the tile/)
    await refused('Seed', '1.5', /a whole number/)
    await refused('Texels a side', 'many', /a number from 16 to 1024/)
    // The profile's own table sets this bound.
    await refused('Relief height', '2', /at most 0\.6/)
    expect(await page.locator('#banner').isVisible()).toBe(false)
    expect(meanDifference(before, await picture(page))).toBeLessThan(0.1)
  })

  it('makes the same foil of the same seed', async () => {
    const { page } = await design('?scene=vase&environment=none', 820, 420)
    await makePolygons(page)
    const one = await savedFiles(page)
    await page.getByRole('button', { name: 'Another seed' }).click()
    await page.waitForTimeout(1000)
    await page.locator('.design [role=status]', { hasText: 'On show' }).waitFor()
    const other = await savedFiles(page)
    await page.getByLabel('Seed', { exact: true }).fill('1')
    await page.waitForTimeout(1000)
    await page.locator('.design [role=status]', { hasText: 'On show' }).waitFor()
    const again = await savedFiles(page)
    const image = 'my-foil.grating.png'
    expect(again[image]).toEqual(one[image])
    expect(other[image]).not.toEqual(one[image])
  })

  it.each(['card', 'note'])(
    'makes foils that a link holds, to the texel, on the %s',
    async (scene) => {
      const permissions = ['clipboard-read', 'clipboard-write']
      const { page } = await design(`?scene=${scene}&environment=none`, 1200, 420, { permissions })
      const pattern = page.getByLabel('Pattern', { exact: true })
      const patterns = await pattern.locator('option').allInnerTexts()
      expect(patterns).not.toContain('Designed here')
      // Of the foil that was there, of shapes, and of these with other periods.
      const ways = [
        async (): Promise<void> => {
          await page.getByLabel('Periods by orientation').check()
          await page.getByLabel('Ranges of orientation').fill('5')
          await page.locator('.design [role=status]', { hasText: 'On show' }).waitFor()
        },
        async (): Promise<void> => {
          await page.getByLabel('Strewn shapes').check()
          await page.getByLabel('Seed', { exact: true }).fill('77')
          await makePolygons(page)
        },
        async (): Promise<void> => {
          await page.getByLabel('Periods by orientation').check()
          await page.getByLabel('Period at 0°').fill('0.875')
          await page.waitForTimeout(1000)
          await page.locator('.design [role=status]', { hasText: 'On show' }).waitFor()
        },
      ]
      // One way on the note: it differs in how often a tile repeats.
      for (const make of scene === 'card' ? ways : ways.slice(1, 2)) {
        await make()
        const before = await picture(page)
        const files = await savedFiles(page)
        expect(await pattern.locator('option:checked').innerText()).toBe('Designed here')
        await page.getByRole('button', { name: 'Share' }).press('Enter')
        await page.getByText('The link is copied.').waitFor()
        const { search } = new URL(await page.evaluate(() => navigator.clipboard.readText()))

        const again = await design(search, 1200, 420)
        expect(meanDifference(before, await picture(again.page))).toBeLessThan(0.1)
        const image = 'my-foil.grating.png'
        expect((await savedFiles(again.page))[image]).toEqual(files[image])
        expect(await fieldsOf(again.page)).toEqual(await fieldsOf(page))
        expect(again.complaints).toEqual([])
        // A link of what was opened is the same.
        await again.page.getByRole('button', { name: 'Share' }).press('Enter')
        await expect.poll(() => new URL(again.page.url()).search).toBe(search)
        await again.page.context().close()
      }
      // Another pattern leaves it.
      await pattern.selectOption('Stars')
      await settle(page)
      expect(await pattern.locator('option').allInnerTexts()).toEqual(patterns)
      expect(await page.getByText('Take it with you').isVisible()).toBe(false)
      await page.getByRole('button', { name: 'Share' }).press('Enter')
      await expect
        .poll(() => Object.fromEntries(new URL(page.url()).searchParams))
        .toMatchObject({ foil: '/maps/baked/foil-stars' })
      expect(page.url()).not.toMatch(/strewn|periods/)
    },
  )

  it('strews the figure of a picture, of every kind of PNG, as the command does', async () => {
    const kinds = (await python(
      `
from pathlib import Path
import numpy as np
from PIL import Image, PngImagePlugin
folder = Path(input)
rng = np.random.default_rng(3)
colours = rng.integers(0, 256, (11, 17, 4)).astype(np.uint8)
colour = Image.fromarray(colours)
grey = Image.fromarray(colours[..., 0])
palette = colour.convert("RGB").quantize(16)
def lightest(picture):
    return max((colour for _, colour in picture.getcolors()), key=np.sum)
profile = PngImagePlugin.PngInfo()
profile.add(b"gAMA", (100000).to_bytes(4, "big"))
pictures = {
    "rgba": (colour, {}),
    "rgb": (colour.convert("RGB"), {}),
    "rgb-key": (palette.convert("RGB"), {"transparency": lightest(palette.convert("RGB"))}),
    "grey": (grey, {}),
    "grey-alpha": (colour.convert("LA"), {}),
    "grey-key": (palette.convert("L"), {"transparency": lightest(palette.convert("L"))}),
    "bits": (grey.point(lambda value: 255 * (value > 99), "1"), {}),
    "palette": (palette, {}),
    "palette-4": (palette, {"bits": 4}),
    "palette-alpha": (palette, {"transparency": bytes(range(255, 95, -10))}),
    "gamma": (colour, {"pnginfo": profile}),
    "tall": (colour.rotate(90, expand=True), {}),
}
for name, (picture, options) in pictures.items():
    picture.save(folder / f"{name}.png", **options)
colour.convert("RGB").save(folder / "photo.jpg")
Image.fromarray(np.full((9, 9), 60000, np.uint16)).save(folder / "deep.png")
Image.new("L", (2049, 2), 255).save(folder / "wide.png")
Image.new("L", (9, 9), 20).save(folder / "dark.png")
(folder / "cut.png").write_bytes((folder / "rgba.png").read_bytes()[:90])
print(json.dumps(list(pictures)))`,
      folder,
    )) as string[]
    const { page, complaints } = await design('?environment=none', 820, 420, {
      permissions: ['clipboard-read', 'clipboard-write'],
    })
    await page.getByLabel('Texels a side', { exact: true }).fill('64')
    await page.getByLabel('Size of a shape', { exact: true }).fill('7')
    await page.getByLabel('Cover, times over').fill('2')
    await page.getByLabel('Shapes', { exact: true }).selectOption('Of a picture')
    const file = page.getByLabel('Picture, light on dark')
    const said = page.locator('.field', { has: file }).locator('.field-error')
    await said.filter({ hasText: 'Expected a PNG file' }).waitFor()
    const status = page.locator('.design [role=status]')
    for (const kind of kinds) {
      await file.setInputFiles(join(folder, `${kind}.png`))
      await page.waitForTimeout(500)
      await status.filter({ hasText: '64 × 64 texels' }).waitFor()
      await page.getByLabel('Name of the map').fill(`of-${kind}`)
      const files = await savedFiles(page)
      const sidecar = JSON.parse(new TextDecoder().decode(files[`of-${kind}.json`])) as object
      expect(sidecar).toMatchObject({ recipe: { shape: 'mask', mask: `${kind}.png` } })
    }
    const off = await python(
      `
from pathlib import Path
import numpy as np
from precompute.foils.recipe import StochasticFoilRecipe
from precompute.foils.stochastic import stochastic_foil
from precompute.maps import Map
kinds, folder = input[0], Path(input[1])
def off(kind):
    recipe = json.loads((folder / f"of-{kind}.json").read_text())["recipe"]
    stochastic_foil(StochasticFoilRecipe.model_validate(recipe), folder).write(folder, "baked")
    mine, baked = (Map.read(folder / name).tables["grating"].values for name in (f"of-{kind}", "baked"))
    return float(np.abs(mine - baked).max())
print(json.dumps([off(kind) for kind in kinds]))`,
      [kinds, folder],
    )
    expect(Object.fromEntries(kinds.map((kind, i) => [kind, (off as number[])[i]]))).toEqual(
      Object.fromEntries(kinds.map((kind) => [kind, 0])),
    )
    // No link holds it, and that is said.
    await page.getByRole('button', { name: 'Share' }).press('Enter')
    await page.getByText('without the foil: part of it is in a file of yours').waitFor()
    expect(page.url()).not.toMatch(/strewn|foil=/)
    for (const [name, message] of [
      ['photo.jpg', 'a PNG file'],
      ['deep.png', '8 bits a channel, not 16'],
      ['wide.png', 'at most 2048 × 2048 pixels and 16 MB, not 2049 × 2'],
      ['dark.png', 'a light, opaque figure'],
      ['cut.png', 'a PNG that is whole'],
    ] as const) {
      await file.setInputFiles(join(folder, name))
      await said.filter({ hasText: message }).waitFor()
      await status.filter({ hasText: 'the last foil stays' }).waitFor()
    }
    expect(complaints).toEqual([])
  })

  it('stops when it is told to, and when another pattern is chosen', async () => {
    const { page, complaints } = await design('?environment=none', 1200, 420)
    const before = await picture(page)
    const begin = async (): Promise<void> => {
      await page.getByLabel('Texels a side', { exact: true }).fill('1024')
      await page.getByLabel('Size of a shape', { exact: true }).fill('0.06')
      await page.getByRole('button', { name: 'Make the foil' }).press('Enter')
      await page.getByText('Making the foil …').first().waitFor()
    }
    await begin()
    await page.getByRole('button', { name: 'Stop' }).press('Enter')
    await page.locator('.design [role=status]', { hasText: 'Stopped.' }).waitFor()
    expect(meanDifference(before, await picture(page))).toBeLessThan(0.1)
    await begin()
    await page.getByLabel('Pattern', { exact: true }).selectOption('Stars')
    await page.locator('.design [role=status]', { hasText: 'Stopped.' }).waitFor()
    await settle(page)
    expect(await page.getByLabel('Pattern').locator('option:checked').innerText()).toBe('Stars')
    expect(await page.getByRole('button', { name: 'Stop' }).isVisible()).toBe(false)
    expect(complaints).toEqual([])
  })

  it('fits a phone', async () => {
    const { page } = await design('', 360, 740)
    for (const way of ['Strewn shapes', 'Periods by orientation']) {
      await page.getByLabel(way).check()
      await page.getByRole('button', { name: 'Make the foil' }).scrollIntoViewIfNeeded()
      const { over, small } = await dockLayout(page)
      expect(over).toBeLessThanOrEqual(0)
      expect(small).toEqual([])
    }
    await page.keyboard.press('Escape')
    expect(await page.locator('#dock').isVisible()).toBe(false)
  })
})
