import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { LayerRequest } from './harness/layer'
import type { SceneDescription } from './harness/scene-description'
import { openHarness } from './open-harness.mjs'
import { dot, floats, normalized, readScene, render, type HarnessHandle } from './read-scene'

let harness: HarnessHandle

beforeAll(async () => {
  harness = await openHarness()
})

afterAll(async () => {
  await harness.close()
})

async function draw(request: LayerRequest): Promise<{
  pixels: Float32Array
  linked: number[]
  cacheKey: string
  explained: string[]
}> {
  const picture = await harness.page.evaluate((what) => window.harness.drawLayer(what), request)
  return { ...picture, pixels: floats(picture.pixels) }
}

/** The largest difference of two pictures, over the largest number of the second. */
function difference(a: Float32Array, b: Float32Array): number {
  expect(a.length).toBe(b.length)
  let [most, peak] = [0, 0]
  for (let i = 0; i < a.length; i++) {
    most = Math.max(most, Math.abs(a[i]! - b[i]!))
    if (i % 4 < 3) peak = Math.max(peak, Math.abs(b[i]!))
  }
  expect(peak).toBeGreaterThan(0)
  return most / peak
}

const small = async (name: string): Promise<SceneDescription> => ({
  ...(await readScene(name)),
  size: [64, 64],
})

/** A sphere under one light, whose material reflects it as three has it. */
const ball: SceneDescription = {
  size: [48, 48],
  camera: { position: [0, 0, 4], fov_deg: 32 },
  mesh: { kind: 'sphere', radius: 1 },
  surface: { kind: 'grating', period: 1.6, height: 0.1 },
  lights: [{ kind: 'directional', direction: [0.3, 0.1, 1], angularRadius: 0.02 }],
}

describe('a layer of full strength', () => {
  it.each([
    'plane-directional',
    'plane-flash-tinted',
    'sphere-three-lights',
    'environment-studio',
    'flat-grating-rough',
    'height-field-bumps',
  ])('shows what DiffractionMaterial shows: %s', async (name) => {
    const scene = await small(name)
    const settings = (scene.material ?? {}) as LayerRequest['layer'] & object
    const { pixels, explained } = await draw({
      scene,
      base: 'standard',
      parameters: { color: [1, 0.3, 0.1], emissive: [0.2, 0.1, 0.3] },
      layer: settings,
    })
    expect(explained).toContain('diffraction')
    expect(difference(pixels, (await render(harness, scene)).radiance)).toBeLessThan(1e-5)
    expect(harness.complaints).toEqual([])
  })

  it('leaves the base where a foil does not diffract', async () => {
    const scene: SceneDescription = {
      ...(await small('plane-directional')),
      surface: { kind: 'foil', map: '/maps/baked/foil-logo' },
    }
    const parameters = { color: [0.7, 0.2, 0.1] as [number, number, number], roughness: 0.8 }
    const base = (await draw({ scene, base: 'standard', parameters })).pixels
    const both = (await draw({ scene, base: 'standard', parameters, layer: {} })).pixels
    const bare = { scene, base: 'standard', parameters, layer: { strength: 0 } } as const
    expect(difference((await draw(bare)).pixels, base)).toBeLessThan(1e-6)
    // DiffractionMaterial tells what diffracts: over a black base, and what it leaves of a white one.
    const light = await render(harness, { ...scene, material: { color: [0, 0, 0] } })
    const white = await render(harness, { ...scene, material: { color: [1, 1, 1] } })
    const lambert = 1 / Math.PI / Math.hypot(0.35, 1)
    const left = white.radiance.map((value, i) => (value - light.radiance[i]!) / lambert)
    const expected = base.map((value, i) => {
      if (i % 4 === 3) return value
      return value * left[i]! + light.radiance[i]!
    })
    expect(difference(both, expected)).toBeLessThan(1e-5)
    const shares = light.covered.map((pixel) => 1 - left[4 * pixel]!)
    expect(Math.max(...shares)).toBeGreaterThan(0.9)
    expect(Math.min(...shares)).toBeLessThan(0.01)
  })
})

it.each([
  ['a rough one', { roughness: 0.6, metalness: 0.3, emissive: [0.1, 0, 0.2] }],
  // Without anything behind it glass is transparent in the picture; the layer is not.
  ['glass', { roughness: 0.1, transmission: 1 }],
] as const)('mixes with the base by its strength: %s', async (_, parameters) => {
  const request: LayerRequest = {
    scene: ball,
    base: 'physical',
    parameters: { color: [0.8, 0.4, 0.2], ...(parameters as LayerRequest['parameters']) },
  }
  const base = (await draw(request)).pixels
  const whole = (await draw({ ...request, layer: {} })).pixels
  const part = (await draw({ ...request, layer: { strength: 0.3 } })).pixels
  const expected = base.map((value, i) => 0.7 * value + 0.3 * whole[i]!)
  expect(difference(part, expected)).toBeLessThan(1e-6)
  const middle = 4 * (24 * 48 + 24)
  expect(whole[middle + 3]).toBe(1)
  if ('transmission' in parameters) expect(base[middle + 3]).toBeLessThan(0.9)
})

it('lies under a clearcoat, which takes its share once and adds its own light', async () => {
  const scene: SceneDescription = { ...ball, environment: { constant: [0.5, 0.5, 0.5] } }
  const coated = {
    clearcoat: 1,
    clearcoatRoughness: 0.2,
    roughness: 1,
    color: [0, 0, 0] as [number, number, number],
    specularIntensity: 0,
  }
  const layer = (
    await draw({ scene, base: 'physical', parameters: { ...coated, clearcoat: 0 }, layer: {} })
  ).pixels
  const coat = (await draw({ scene, base: 'physical', parameters: coated })).pixels
  const both = (await draw({ scene, base: 'physical', parameters: coated, layer: {} })).pixels
  const geometry = await render(harness, scene)
  const { covered } = geometry
  expect(covered.length).toBeGreaterThan(1000)
  const highlight = Math.max(...covered.map((pixel) => coat[4 * pixel]!))
  expect(highlight).toBeGreaterThan(0.1)
  for (const pixel of covered) {
    // Schlick's approximation, index 1.5; three's fit to its power is off by 0.0038 at most.
    const cosine = -dot(
      geometry.vector('normal', pixel),
      normalized(geometry.vector('position', pixel)),
    )
    const through = 0.96 * (1 - (1 - cosine) ** 5)
    for (const i of [4 * pixel, 4 * pixel + 1, 4 * pixel + 2]) {
      const expected = through * layer[i]! + coat[i]!
      expect(Math.abs(both[i]! - expected)).toBeLessThan(0.004 * Math.abs(layer[i]!) + 1e-6)
    }
  }
})

describe('hooks of others', () => {
  it.each(['before', 'after', 'around'] as const)('work if they are set %s', async (hook) => {
    const request: LayerRequest = { scene: ball, base: 'standard', layer: {} }
    const mesh = { ...ball.mesh, position: [0.25, 0, 0] as [number, number, number] }
    const moved = (await draw({ ...request, scene: { ...ball, mesh } })).pixels
    const hooked = (await draw({ ...request, hook })).pixels
    const expected = moved.map((value, i) => (i % 4 === 0 ? 0.5 * value : value))
    expect(difference(hooked, expected)).toBeLessThan(1e-6)
  })

  it('stay when the layer goes, and the material is as it was', async () => {
    for (const hook of [undefined, 'before', 'after', 'around'] as const) {
      const request: LayerRequest = {
        scene: ball,
        base: 'standard',
        parameters: { roughness: 0.4 },
      }
      const set = hook && { hook }
      const without = await draw({ ...request, ...(hook && { hook: 'before' }) })
      const removed = await draw({ ...request, ...set, layer: {}, removed: true })
      expect(removed.pixels, hook).toEqual(without.pixels)
      if (hook !== 'around') expect(removed.cacheKey).toBe(without.cacheKey)
    }
  })
})

it('is compiled once, and not again while nothing changes', async () => {
  const scene: SceneDescription = { ...ball, environment: { constant: [1, 1, 1] } }
  const { linked } = await draw({
    scene,
    base: 'physical',
    parameters: { clearcoat: 1 },
    layer: { roughness: 0.02 },
    frames: 5,
  })
  expect(linked.slice(2)).toEqual([0, 0, 0])
})

describe('a layer on a material that was drawn before', () => {
  const grating = { kind: 'grating', period: 0.9, height: 0.1 } as const
  const foil = { kind: 'foil', map: '/maps/baked/foil-polygons' } as const
  const otherFoil = { kind: 'foil', map: '/maps/baked/foil-logo' } as const
  const field = { kind: 'height-field', field: 'cosine' } as const

  it.each([
    ['another grating', [grating], ball.surface],
    ['another foil', [otherFoil], foil],
    ['the first kind again', [grating, foil], ball.surface],
    ['a height field and back', [foil, field], otherFoil],
  ] as const)('shows its own surface: %s', async (_, surfaces, surface) => {
    const request: LayerRequest = { scene: { ...ball, surface }, base: 'standard', layer: {} }
    const { pixels } = await draw(request)
    for (const by of ['one layer', 'layers'] as const) {
      const again = await draw({ ...request, earlier: { surfaces: [...surfaces], by } })
      expect.soft(difference(again.pixels, pixels), by).toBeLessThan(1e-6)
    }
  })

  it('stays on it when the material copies another', async () => {
    const request: LayerRequest = { scene: ball, base: 'physical', layer: {} }
    const { pixels } = await draw(request)
    expect(difference((await draw({ ...request, copied: true })).pixels, pixels)).toBeLessThan(1e-6)
  })
})
