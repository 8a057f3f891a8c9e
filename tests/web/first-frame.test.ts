import {
  BufferGeometry,
  DataTexture,
  EquirectangularReflectionMapping,
  Group,
  Mesh,
  PerspectiveCamera,
  Scene,
  type WebGLRenderer,
} from 'three'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { loadSharedMap } from '../../web/maps/cache'
import { loadMap, type LoadedMap } from '../../web/maps/load'
import { DiffractionMaterial } from '../../web/materials/DiffractionMaterial'
import { DEFAULT_SETTINGS } from '../../web/materials/options'
import { solvePositive } from '../../web/spectrum/solve-positive'
import { atOnce, bitByBit, type Steps } from '../../web/steps'
import { Foil } from '../../web/surfaces/foil'
import { Grating } from '../../web/surfaces/grating'
import { HeightField } from '../../web/surfaces/height-field'
import type { OpticsSettings, Surface } from '../../web/surfaces/surface'
import { serveBakedMaps } from './baked-maps'

vi.mock(import('../../web/steps'), { spy: true })
vi.mock(import('../../web/spectrum/solve-positive'), { spy: true })

const mapsPath = 'maps/baked/'

/** Steps that were left to a single task, and those that were taken in between others. */
let steps = 0
let stepsBetween = 0

const { bitByBit: inBetween } =
  await vi.importActual<typeof import('../../web/steps')>('../../web/steps')

beforeEach(() => {
  serveBakedMaps()
  steps = stepsBetween = 0
  vi.mocked(bitByBit).mockImplementation(<Result>(work: Steps<Result>): Promise<Result> => {
    function* counted(): Steps<Result> {
      let step = work.next()
      for (; !step.done; step = work.next()) {
        stepsBetween++
        yield
      }
      return step.value
    }
    return inBetween(counted())
  })
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

it('leaves no work on a height field to the first frame', async () => {
  const surface = new HeightField({ field: 'bumps', ior: 1.5 })
  const material = new DiffractionMaterial({ surface, mapsPath })
  await material.ready
  const { method, energy } = material
  await makeTables(surface, { ...DEFAULT_SETTINGS, method, energy }, ['uEnvironmentSamples'])
  expect(steps).toBe(0)
})

describe('a height field whose settings change', () => {
  const scene = new Scene()
  scene.environment = new DataTexture(new Float32Array(4 * 8), 4, 2)
  scene.environment.mapping = EquirectangularReflectionMapping
  scene.environment.needsUpdate = true

  /** What a frame reads of the environment, and how. */
  function drawn(material: DiffractionMaterial): {
    samples: DataTexture
    defines: DiffractionMaterial['defines']
  } {
    const renderer = { info: { render: { frame: 0 } } } as object as WebGLRenderer
    const geometry = new BufferGeometry()
    const camera = new PerspectiveCamera()
    const mesh = new Mesh(geometry, material)
    material.onBeforeRender(renderer, scene, camera, geometry, mesh, new Group())
    const { value } = material.uniforms.uEnvironmentSamples as { value: DataTexture }
    return { samples: value, defines: { ...material.defines } }
  }

  /** Each test has a number of nodes of its own: samples are made once for all that agree on it. */
  async function made(environmentNodes: number): Promise<DiffractionMaterial> {
    const surface = new HeightField({ field: 'bumps' })
    const material = new DiffractionMaterial({ surface, mapsPath, environmentNodes })
    await material.ready
    stepsBetween = 0
    return material
  }

  /** Texels under the material's settings, of maps that nobody else reads. */
  async function texelsMadeAtOnce(material: DiffractionMaterial): Promise<unknown> {
    const { metal, energy, method, illuminant, environmentNodes, surface } = material
    const settings = { ...DEFAULT_SETTINGS, metal, energy, method, illuminant, environmentNodes }
    const tables: Record<string, LoadedMap> = {}
    for (const [name, url] of Object.entries(surface.tables(settings, mapsPath)))
      tables[name] = await loadMap(url)
    const { uEnvironmentSamples } = surface.optics(tables, settings).environmentUniforms()
    return (uEnvironmentSamples!.value as DataTexture).image.data
  }

  const others = (): Promise<void> => new Promise((resolve) => setTimeout(resolve, 20))

  it.each<[string, number, (material: DiffractionMaterial) => unknown]>([
    ['metal', 2, (material) => (material.metal = 'gold')],
    ['environmentNodes', 3, (material) => (material.environmentNodes = 5)],
    ['energy', 4, (material) => (material.energy = 'relative')],
    ['ior', 6, ({ surface }) => surface instanceof HeightField && (surface.ior = 1.5)],
  ])('is drawn as before until samples for its %s are there', async (name, nodes, change) => {
    const material = await made(nodes)
    const before = drawn(material)
    change(material)
    const meanwhile = drawn(material)
    expect(meanwhile.samples).toBe(before.samples)
    expect(meanwhile.defines).toEqual(before.defines)
    await material.ready
    const after = drawn(material)
    expect(after.samples).not.toBe(before.samples)
    expect(after.defines.ENVIRONMENT_SAMPLES).toBe(16 * material.environmentNodes)
    expect('DIELECTRIC' in after.defines).toBe(name === 'ior')
    expect(stepsBetween).toBeGreaterThan(32)
    expect(steps).toBe(0)
    expect(after.samples.image.data).toEqual(await texelsMadeAtOnce(material))
  })

  it('is drawn by the last of them, whoever waits for an earlier one', async () => {
    const material = await made(7)
    const before = drawn(material)
    material.environmentNodes = 8
    const { ready } = material
    await others()
    material.environmentNodes = 9
    await ready
    expect(drawn(material).samples.image.height).toBe(16 * 9)
    // What has been made is taken at once; what was on its way is left.
    material.environmentNodes = 10
    await others()
    material.environmentNodes = 7
    expect(drawn(material).samples).toBe(before.samples)
    await others()
    const left = stepsBetween
    await others()
    expect(stepsBetween).toBe(left)
    expect(drawn(material).samples).toBe(before.samples)
    expect(steps).toBe(0)
  })

  it.each<[string, (material: DiffractionMaterial) => void, number]>([
    ['other samples', (material) => (material.environmentNodes = 13), 13],
    ['what is there already', (material) => (material.illuminant = 'D65'), 12],
  ])('leaves samples of other tables for %s', async (_name, change, nodes) => {
    const material = await made(12)
    material.illuminant = 'LED-B1'
    const { ready } = material
    await vi.waitUntil(() => stepsBetween > 0, { interval: 1 })
    change(material)
    const { illuminant } = material
    await ready
    await others()
    expect(material).toMatchObject({ illuminant, environmentNodes: nodes })
    expect(drawn(material).samples.image.height).toBe(16 * nodes)
    expect(drawn(material).samples.image.data).toEqual(await texelsMadeAtOnce(material))
  })

  it('refuses what does not fit at once, and goes on to what was asked for before', async () => {
    const material = await made(11)
    material.metal = 'copper'
    expect(() => (material.energy = 'conserving')).toThrow()
    expect(material).toMatchObject({ metal: 'copper', energy: 'kirchhoff' })
    await material.ready
    expect(drawn(material).samples.image.data).toEqual(await texelsMadeAtOnce(material))
  })
})

it.each([1, 2, 12, 50, 101, 200, 201, 401])(
  'leaves at most two systems of equations for %s nodes of a grating to the first frame',
  async (environmentNodes) => {
    const grating = new Grating({ period: 1.6, height: 0.1 })
    const settings = { ...DEFAULT_SETTINGS, environmentNodes }
    const tables: Record<string, LoadedMap> = {}
    for (const [name, url] of Object.entries(grating.tables(settings, mapsPath)))
      tables[name] = await loadMap(url)
    const { environmentUniforms, environmentRefinement } = grating.optics(tables, settings)
    vi.mocked(solvePositive).mockClear()
    environmentUniforms()
    environmentRefinement!.uniforms(16)
    const sizes = vi.mocked(solvePositive).mock.calls.map(([matrix]) => matrix.length + 1)
    // Nodes of 1 nm and more: the spectrum has 401 of them.
    const shares = [8, 4, 2, 1].find((count) => count * environmentNodes <= 401)!
    const expected = [environmentNodes, shares * environmentNodes]
    expect(sizes).toEqual(shares === 1 ? expected.slice(1) : expected)
  },
)
