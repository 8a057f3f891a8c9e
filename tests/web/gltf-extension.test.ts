import { MeshStandardMaterial } from 'three'
import { afterAll, beforeAll, describe, expect, it, vi } from 'vitest'
import type { DiffractionError } from '../../web/errors'
import { EXTENSION } from '../../web/gltf'
import { codeBlocks } from '../docs/markdown'
import { FAKES, fakeGlbs, serveFakes, type FakeName } from './gltf-fakes'
import {
  diffractingOf,
  glbOf,
  load,
  materialsOf,
  partsOf,
  stubBrowser,
  type Json,
} from './gltf-files'
import { schemaErrors } from './gltf-schema'

let files: Record<FakeName, ArrayBuffer>

beforeAll(async () => {
  stubBrowser()
  serveFakes()
  files = await fakeGlbs()
})

afterAll(() => {
  vi.unstubAllGlobals()
})

const options = { mapsPath: FAKES }
type Path = readonly (string | number)[]

/** A file with a value in the place of another; an undefined one leaves the field out. */
function changed(name: FakeName, path: Path, value: unknown): { json: Json; glb: ArrayBuffer } {
  const { json, binary } = partsOf(files[name])
  const last = path.at(-1)!
  let place: Record<string | number, unknown> = json
  for (const key of path.slice(0, -1)) place = place[key] as typeof place
  // Not by assignment, which would take `__proto__` for what it is not.
  Object.defineProperty(place, last, { value, enumerable: true, configurable: true })
  if (value === undefined) Reflect.deleteProperty(place, last)
  return { json, glb: glbOf(JSON.stringify(json), binary) }
}

const textOf = (path: Path): string =>
  path
    .map((key) => (typeof key === 'number' ? `[${key}]` : `.${key}`))
    .join('')
    .slice(1)

/** The one error that loading told of; the material is then the plain one. */
async function refusalOf(glb: ArrayBuffer, path?: string): Promise<DiffractionError> {
  const onError = vi.fn<(error: DiffractionError) => void>()
  const gltf = await load(glb, { ...options, onError }, path)
  expect(onError).toHaveBeenCalledOnce()
  expect(materialsOf(gltf)).toEqual([expect.any(MeshStandardMaterial)])
  return onError.mock.lastCall![0]
}

const MATERIAL = ['materials', 0, 'extensions', EXTENSION] as const
const SURFACE = [...MATERIAL, 'surface'] as const
const RENDERING = [...MATERIAL, 'rendering'] as const
const ROOT = ['extensions', EXTENSION] as const
const MAP = [...ROOT, 'maps', 0] as const

const NUMBERS = { 'no number': '1', null: null, 'a list': [1] }
const SHARE = { ...NUMBERS, below: -0.1, above: 1.1 }
const POSITIVE = { ...NUMBERS, zero: 0, below: -1 }
const NAME = {
  'no text': 1,
  empty: '',
  null: null,
  'a path': '../x',
  backslashes: '..\\x',
  'a percent': '%2e',
}
const CHOICE = { ...NAME, another: 'none' }
const TRUTH = { 'a number': 1, null: null, text: 'true' }
const PAIR = { ...NUMBERS, long: [1, 2, 3], texts: ['1', '2'], null: [null, 1] }
const IOR = { ...NUMBERS, below: 0.9, above: 5 }

const cases = (name: FakeName, path: Path, values: object): [FakeName, Path, string, unknown][] =>
  Object.entries(values).map(([why, value]) => [name, path, why, value])

/** What neither the schemas nor the loader let pass. */
const REFUSED = [
  ...cases('grating', MATERIAL, { 'no object': 1, null: null, 'a list': [] }),
  ...cases('grating', SURFACE, { missing: undefined, 'no object': 1, null: null }),
  ...cases('grating', [...SURFACE, 'kind'], {
    missing: undefined,
    another: 'film',
    'own name': 'constructor',
  }),
  ...cases('grating', [...SURFACE, 'period'], { missing: undefined, ...POSITIVE }),
  ...cases('grating', [...SURFACE, 'height'], { missing: undefined, ...POSITIVE }),
  ...cases('grating', [...SURFACE, 'profile'], NAME),
  ...cases('grating', [...SURFACE, 'orientation'], NUMBERS),
  ...cases('grating', [...SURFACE, 'tracks'], CHOICE),
  ...cases('grating', [...SURFACE, 'strength'], SHARE),
  ...cases('grating', [...SURFACE, 'ior'], { 'of another kind': 1.5 }),
  ...cases('grating', [...SURFACE, '__proto__'], { there: { period: 1 } }),
  ...cases('grating', [...MATERIAL, 'metal'], CHOICE),
  ...cases('grating', [...MATERIAL, 'illuminant'], NAME),
  ...cases('grating', [...MATERIAL, 'observer'], CHOICE),
  ...cases('grating', [...MATERIAL, 'energy'], CHOICE),
  ...cases('grating', [...MATERIAL, 'roughness'], { ...NUMBERS, below: -0.1, above: 1.6 }),
  ...cases('grating', [...MATERIAL, 'coherence'], POSITIVE),
  ...cases('grating', [...MATERIAL, 'lightAngularRadius'], { ...POSITIVE, above: 1.6 }),
  ...cases('grating', [...MATERIAL, 'coat'], SHARE),
  ...cases('grating', [...MATERIAL, 'coatIor'], IOR),
  ...cases('grating', [...MATERIAL, 'coatRoughness'], SHARE),
  ...cases('grating', [...MATERIAL, 'matteColorFactor'], {
    ...NUMBERS,
    long: [1, 1, 1, 1],
    above: [1, 1, 2],
    below: [-1, 0, 0],
  }),
  ...cases('grating', [...MATERIAL, 'matteColorTexture'], { 'no object': 1, null: null }),
  ...cases('grating', [...MATERIAL, 'colour'], { unknown: 1 }),
  ...cases('grating', RENDERING, { 'no object': 1, null: null }),
  ...cases('grating', [...RENDERING, 'method'], CHOICE),
  ...cases('grating', [...RENDERING, 'efficiencies'], CHOICE),
  ...cases('grating', [...RENDERING, 'wavelengthStep'], { ...NUMBERS, endless: 1e-9, above: 1 }),
  ...cases('grating', [...RENDERING, 'environmentNodes'], {
    ...NUMBERS,
    'not whole': 1.5,
    zero: 0,
    above: 1e9,
  }),
  ...cases('grating', [...RENDERING, 'maxError'], POSITIVE),
  ...cases('grating', [...RENDERING, 'planarEnvironment'], TRUTH),
  ...cases('grating', [...RENDERING, 'gamut'], CHOICE),
  ...cases('grating', [...RENDERING, 'diffraction'], TRUTH),
  ...cases('grating', [...RENDERING, 'quality'], { unknown: 'high' }),
  ...cases('tables', [...SURFACE, 'profileMap'], {
    'no number': '0',
    null: null,
    below: -1,
    'not whole': 0.5,
  }),
  ...cases('tables', [...MATERIAL, 'illuminantMap'], { 'no number': '0', null: null }),
  ...cases('foil', [...SURFACE, 'map'], {
    missing: undefined,
    'no number': '0',
    null: null,
    below: -1,
  }),
  ...cases('foil', [...SURFACE, 'height'], POSITIVE),
  ...cases('foil', [...SURFACE, 'repeat'], { ...PAIR }),
  ...cases('foil', [...SURFACE, 'filtered'], TRUTH),
  ...cases('foil', [...SURFACE, 'period'], { 'of another kind': 1.5 }),
  ...cases('heightField', [...SURFACE, 'maps'], { missing: undefined, 'no object': 1, none: {} }),
  ...cases('heightField', [...SURFACE, 'maps', 'jacobi-anger'], { 'no number': '0', null: null }),
  ...cases('heightField', [...SURFACE, 'maps', 'fourier'], { unknown: 0 }),
  ...cases('heightField', [...SURFACE, 'strength'], SHARE),
  ...cases('heightField', [...SURFACE, 'ior'], IOR),
  ...cases('heightField', [...SURFACE, 'tiles'], { ...PAIR, 'not whole': [1.5, 1], zero: [0, 1] }),
  ...cases('foil', ROOT, { 'no object': 1, null: null }),
  ...cases('foil', [...ROOT, 'maps'], { missing: undefined, 'no list': {} }),
  ...cases('foil', [...ROOT, 'atlas'], { unknown: 0 }),
  ...cases('foil', [...MAP, 'format'], { another: 'png' }),
  ...cases('foil', [...MAP, 'version'], { another: 2 }),
  ...cases('foil', [...MAP, 'kind'], { another: 'metal' }),
  ...cases('foil', [...MAP, 'sampler'], { unknown: 0 }),
  ...cases('foil', [...MAP, 'constants', 'height_um'], { 'no number': '1', null: null }),
  ...cases('foil', [...MAP, 'arrays', 'grating', 'bufferView'], {
    missing: undefined,
    'no number': '0',
    null: null,
    below: -1,
  }),
  ...cases('foil', [...MAP, 'arrays', 'grating', 'file'], { unknown: 'x.png' }),
  ...cases('foil', [...MAP, 'arrays', 'grating', 'dtype'], { another: 'float64' }),
  ...cases('foil', [...MAP, 'arrays', 'grating', 'shape'], { 'no list': 4, short: [2] }),
  ...cases('foil', [...MAP, 'arrays', 'grating', 'decode'], {
    missing: undefined,
    short: [[0, 1]],
  }),
  ...cases('foil', [...MAP, 'arrays', '__proto__'], { there: {} }),
  ...cases('heightField', [...MAP, 'arrays', 'powers', 'axes', 0, 'colour'], { unknown: 1 }),
]

/** What only the loader can know. */
const LOADER_ONLY = [
  ...cases('grating', [...SURFACE, 'height'], { 'beyond the table': 3 }),
  ...cases('grating', [...MATERIAL, 'energy'], { "a height field's": 'relative' }),
  ...cases('grating', [...RENDERING, 'method'], { "a height field's": 'line-sum' }),
  ...cases('grating', [...MATERIAL, 'matteColorTexture'], { 'not there': { index: 7 } }),
  ...cases('foil', [...SURFACE, 'map'], { 'not there': 5, many: 2 ** 53 }),
  ...cases('foil', [...MAP, 'arrays', 'grating', 'bufferView'], { 'not there': 99 }),
  ...cases('foil', [...MAP, 'constants', 'height_um'], { missing: undefined }),
  ...cases('foil', [...MAP, 'arrays', 'grating', 'shape'], {
    vast: [8192, 8192, 4],
    endless: [2 ** 40, 2 ** 40, 4],
  }),
  ...cases('foil', ['bufferViews', 4, 'byteLength'], { 'none at all': undefined, vast: 2 ** 31 }),
  ...cases('tables', [...MAP, 'constants', 'max_order'], { 'without end': 1e308 }),
  ...cases('tables', [...ROOT, 'maps', 1, 'constants', 'wide_lobe_nodes'], { 'without end': 1e9 }),
  ...cases('heightField', [...MAP, 'constants', 'period_x'], { 'no patch': 0 }),
  ...cases('baked', [...MAP, 'arrays', 'powers', 'axes'], { none: undefined }),
  ...cases('heightField', RENDERING, { 'of a missing map': { method: 'baked' } }),
]

describe('the examples of the documentation', () => {
  const examples = codeBlocks('docs/gltf/README.md')
    .filter(({ language, rule }) => language === 'json' && rule === 'gltf')
    .map(({ code }) => JSON.parse(code) as Json)

  it('are as its schemas say', () => {
    expect(examples).toHaveLength(2)
    for (const example of examples) {
      expect(JSON.stringify(example)).toContain(EXTENSION)
      expect(schemaErrors(example)).toEqual([])
    }
  })

  it('can be shown', async () => {
    const { json, binary } = partsOf(files.grating)
    json.materials = examples[0]!.materials
    const extension = (json.materials as { extensions: Record<string, { surface: Json }> }[])[0]!
      .extensions[EXTENSION]!
    // The one profile that is served here.
    extension.surface.profile = 'sinusoidal'
    const [material] = await diffractingOf(await load(glbOf(JSON.stringify(json), binary), options))
    expect(material).toMatchObject({ name: 'Compact disc', coat: 1, roughness: 0.01 })
    expect(material!.surface).toMatchObject({ period: 1.6, tracks: 'circular' })
  })
})

describe('a file', () => {
  it('is shown as it is, with what glTF lets stand anywhere', async () => {
    for (const name of Object.keys(files) as FakeName[]) {
      const { json, binary } = partsOf(files[name])
      expect(schemaErrors(json)).toEqual([])
      const places = [
        MATERIAL,
        SURFACE,
        ...(json.extensions ? [ROOT, MAP, [...MAP, 'arrays']] : []),
      ]
      for (const path of places) {
        let place: Json = json
        for (const key of path) place = (place as Record<string | number, Json>)[key]!
        const own = path.at(-1) === 'arrays' ? Object.values(place) : [place]
        for (const object of own)
          Object.assign(object as object, { extras: 1, extensions: { NONE_x: {} } })
      }
      expect(schemaErrors(json)).toEqual([])
      await diffractingOf(await load(glbOf(JSON.stringify(json), binary), options))
    }
  })

  it.each(REFUSED)(
    'of a %s with %j %s is refused by schema and loader',
    async (name, path, _why, value) => {
      const { json, glb } = changed(name, path, value)
      expect(schemaErrors(json)).not.toEqual([])
      const error = await refusalOf(glb)
      expect(error.file).toBe('glTF')
      expect(error.field.startsWith(textOf(path)), `${error.field} is named`).toBe(true)
    },
  )

  it.each(LOADER_ONLY)(
    'of a %s with %j %s is refused by the loader',
    async (name, path, _why, value) => {
      const { json, glb } = changed(name, path, value)
      expect(schemaErrors(json)).toEqual([])
      const error = await refusalOf(glb)
      expect(error.file).toBe('glTF')
      expect(error.field.startsWith(textOf(path)), `${error.field} is named`).toBe(true)
    },
  )
})
