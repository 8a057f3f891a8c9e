import { afterEach, expect, it, vi } from 'vitest'
import { expectSound } from '../../web/gltf/sound-map'
import { loadMap } from '../../web/maps/load'
import {
  fakeBaked,
  fakeFoil,
  fakeLobes,
  fakeMetals,
  fakeProfile,
  fakeTerms,
  filesOf,
  halves,
  serveFiles,
  sha256,
  type FakeMap,
} from './fake-maps'
import { refuses } from './refuses'

afterEach(() => {
  vi.unstubAllGlobals()
})

type Spec = Record<string, unknown> & { axes: Record<string, unknown>[] }

const MAPS = {
  profile: fakeProfile,
  lobes: fakeLobes,
  metals: fakeMetals,
  foil: fakeFoil,
  terms: fakeTerms,
  baked: fakeBaked,
}
type Name = keyof typeof MAPS

async function load({ sidecar, files }: FakeMap): ReturnType<typeof loadMap> {
  serveFiles(filesOf({ 'maps/x': { sidecar, files } }))
  return loadMap('maps/x')
}

function specOf(map: FakeMap, name: string): Spec {
  return (map.sidecar.arrays as Record<string, Spec>)[name]!
}

it.each(Object.keys(MAPS) as Name[])('a map as it is baked can be relied on: %s', async (name) => {
  const map = await load(MAPS[name]())
  expect(expectSound(map)).toBe(map)
})

it.each<[Name, string, number]>([
  ['profile', 'max_order', 2],
  ['profile', 'max_order', 1e308],
  ['lobes', 'wide_lobe_nodes', 1e9],
  ['lobes', 'wide_lobe_nodes', 2.5],
  ['lobes', 'wide_lobe_nodes', 0],
  ['terms', 'terms', 4],
  ['terms', 'period_x', 0],
  ['terms', 'period_y', -1],
])('a map of %s with a %s of %s cannot', async (name, constant, value) => {
  const map = MAPS[name]()
  ;(map.sidecar.constants as Record<string, number>)[constant] = value
  const loaded = await load(map)
  refuses(() => expectSound(loaded), 'maps/x.json', `constants.${constant}`)
})

it.each<[Name, string]>([
  ['profile', 'efficiency'],
  ['lobes', 'lobe'],
  ['lobes', 'weights'],
  ['metals', 'reflectance'],
  ['terms', 'coefficients'],
  ['terms', 'powers'],
  ['baked', 'coherent'],
  ['baked', 'powers'],
])('a map of %s without axes of its %s cannot', async (name, array) => {
  const map = MAPS[name]()
  Reflect.deleteProperty(specOf(map, array), 'axes')
  const loaded = await load(map)
  refuses(() => expectSound(loaded), 'maps/x.json', `arrays.${array}.axes`)
})

it('a map whose recipe is nested too deep cannot', async () => {
  const loaded = await load(fakeFoil())
  loaded.sidecar.recipe = JSON.parse(`{"x": ${'['.repeat(2e4)}${']'.repeat(2e4)}}`) as Record<
    string,
    unknown
  >
  refuses(() => expectSound(loaded), 'maps/x.json', 'recipe')
})

it('a map of a profile whose orders are others than its rows cannot', async () => {
  const map = fakeProfile()
  specOf(map, 'efficiency').axes[0]!.last = 9
  const loaded = await load(map)
  refuses(() => expectSound(loaded), 'maps/x.json', 'arrays.efficiency.axes[0]')
})

it.each<[Name, string, string, number[], number]>([
  ['lobes', 'weights', 'float32', [5000, 9], 0],
  ['lobes', 'weights', 'float32', [1, 9], 0],
  ['metals', 'reflectance', 'float16', [1, 1, 4], 1],
  ['terms', 'terms', 'float16', [4, 3, 2, 4], 0],
  ['terms', 'terms', 'float16', [3, 2, 2, 4], NaN],
  ['terms', 'places', 'float32', [513, 4], 0],
  ['terms', 'powers', 'float32', [3, 3, 1], 0],
  ['terms', 'powers', 'float32', [2, 1, 1], 1],
  ['baked', 'modes', 'float16', [6, 4, 4, 4], 0],
])('a map of %s with %s as %s of %j cannot', async (name, array, dtype, shape, axis) => {
  const loaded = await load(resized(MAPS[name](), array, dtype, shape))
  const field = `arrays.${array}.shape${Number.isNaN(axis) ? '' : `[${axis}]`}`
  refuses(() => expectSound(loaded), 'maps/x.json', field)
})

it.each<[Name, string, number[]]>([
  ['profile', 'efficiency', [3, 8, 1]],
  ['lobes', 'lobe', [3, 4, 8, 4]],
  ['metals', 'reflectance', [1, 16, 4]],
  ['baked', 'modes', [3, 4, 4, 4]],
  ['baked', 'coherent', [3, 8, 4]],
])('a map of %s with %s in single precision cannot', async (name, array, shape) => {
  const loaded = await load(resized(MAPS[name](), array, 'float32', shape))
  refuses(() => expectSound(loaded), 'maps/x.json', `arrays.${array}.dtype`)
})

/** The map with an array of another size or type. */
function resized(map: FakeMap, name: string, dtype: string, shape: number[]): FakeMap {
  const spec = specOf(map, name)
  const values = Array.from({ length: shape.reduce((a, b) => a * b) }, () => 0.5)
  const bytes =
    dtype === 'float16' ? halves(values) : new Uint8Array(Float32Array.from(values).buffer)
  map.files[spec.file as string] = bytes
  Object.assign(spec, { dtype, shape, sha256: sha256(bytes) })
  spec.axes.forEach((axis, i) => {
    Object.assign(axis, { size: shape[i], last: shape[i] === 1 ? axis.first : axis.last })
  })
  return map
}
