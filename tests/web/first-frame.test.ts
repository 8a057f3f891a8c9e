import type { DataTexture } from 'three'
import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import { loadSharedMap } from '../../web/maps/cache'
import { loadMap, type LoadedMap } from '../../web/maps/load'
import { DiffractionMaterial } from '../../web/materials/DiffractionMaterial'
import { DEFAULT_SETTINGS } from '../../web/materials/options'
import { atOnce, type Steps } from '../../web/steps'
import { Foil } from '../../web/surfaces/foil'
import { HeightField } from '../../web/surfaces/height-field'
import type { OpticsSettings, Surface } from '../../web/surfaces/surface'
import { serveBakedMaps } from './baked-maps'

vi.mock(import('../../web/steps'), { spy: true })

const mapsPath = 'maps/baked/'

/** Steps that were left to a single task. */
let steps = 0

beforeEach(() => {
  serveBakedMaps()
  steps = 0
  vi.mocked(atOnce).mockImplementation(<Result>(work: Steps<Result>): Result => {
    let step = work.next()
    for (; !step.done; step = work.next()) steps++
    return step.value
  })
})

afterEach(() => {
  vi.unstubAllGlobals()
})

/** Makes what a frame under lights and an environment reads, and looks into some of its tables. */
async function makeTables(
  surface: Surface,
  settings: OpticsSettings,
  names: readonly string[],
): Promise<void> {
  const tables: Record<string, LoadedMap> = {}
  for (const [name, url] of Object.entries(surface.tables(settings, mapsPath)))
    tables[name] = await loadSharedMap(url)
  const { uniforms, environmentUniforms } = surface.optics(tables, settings)
  const all = { ...uniforms, ...environmentUniforms() }
  for (const name of names) {
    const { value } = all[name] as { value: DataTexture }
    expect(value.image.data!.some((texel) => texel !== 0)).toBe(true)
  }
}

it.each([
  ['few gratings', 'foil-polygons', ['uFoilShares']],
  ['many gratings', 'foil-glitter', ['uFoilClusters', 'uFoilArcClusters']],
])('leaves no work on a foil of %s to the first frame', async (_name, name, tables) => {
  const foil = await Foil.of(await loadMap(mapsPath + name))
  await makeTables(foil, DEFAULT_SETTINGS, tables)
  expect(steps).toBe(0)
})

it('does all of the work on a foil at once where it was not done before', async () => {
  const map = await loadMap('maps/baked/foil-glitter')
  expect(new Foil(map).isPartial).toBe((await Foil.of(map)).isPartial)
  expect(steps).toBeGreaterThan(256)
})

it('leaves no work on a height field to the first frame, but for settings that change', async () => {
  const surface = new HeightField({ field: 'bumps', ior: 1.5 })
  const material = new DiffractionMaterial({ surface, mapsPath })
  await material.ready
  const { method, energy } = material
  const settings = { ...DEFAULT_SETTINGS, method, energy }
  await makeTables(surface, settings, ['uEnvironmentSamples'])
  expect(steps).toBe(0)
  await makeTables(surface, { ...settings, environmentNodes: 5 }, ['uEnvironmentSamples'])
  expect(steps).toBeGreaterThan(80)
})
