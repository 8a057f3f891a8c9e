import { DataArrayTexture } from 'three'
import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import { loadMap } from '../../web/maps/load'
import { DEFAULT_SETTINGS } from '../../web/materials/options'
import { atOnce, type Steps } from '../../web/steps'
import { Foil } from '../../web/surfaces/foil'
import { serveBakedMaps } from './baked-maps'

vi.mock(import('../../web/steps'), { spy: true })

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

it.each([
  ['few gratings', 'foil-polygons', ['uFoilShares']],
  ['many gratings', 'foil-glitter', ['uFoilClusters', 'uFoilArcClusters']],
])('leaves no work on a foil of %s to the first frame', async (_name, name, tables) => {
  const map = await loadMap(`maps/baked/${name}`)
  const foil = await Foil.of(map)
  const addresses = Object.entries(foil.tables(DEFAULT_SETTINGS, 'maps/baked/'))
  const maps = await Promise.all(
    addresses.map(async ([key, url]) => [key, await loadMap(url)] as const),
  )
  const { uniforms, environmentUniforms } = foil.optics(Object.fromEntries(maps), DEFAULT_SETTINGS)
  const all = { ...uniforms, ...environmentUniforms() }
  for (const table of tables) {
    const { value } = all[table] as { value: DataArrayTexture }
    expect(value.image.data!.some((texel) => texel !== 0)).toBe(true)
  }
  expect(steps).toBe(0)
})

it('does all of that work at once where a map is not looked at before', async () => {
  const map = await loadMap('maps/baked/foil-glitter')
  expect(new Foil(map).isPartial).toBe((await Foil.of(map)).isPartial)
  expect(steps).toBeGreaterThan(256)
})
