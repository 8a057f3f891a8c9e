import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { GltfOutcome, GltfRequest } from './harness/gltf'
import type { SceneDescription, SurfaceDescription } from './harness/scene-description'
import { openHarness } from './open-harness.mjs'
import type { HarnessHandle } from './read-scene'

let harness: HarnessHandle

beforeAll(async () => {
  harness = await openHarness()
})

afterAll(async () => {
  await harness.close()
})

const pass = (request: GltfRequest): Promise<GltfOutcome> =>
  harness.page.evaluate((asked) => window.harness.passThroughGltf(asked), request)

const SCENE: SceneDescription = {
  size: [48, 48],
  camera: { position: [0.3, 0.4, 2.4], fov_deg: 45 },
  mesh: { kind: 'plane', size: [2, 1.6], rotation_deg: [-20, 15, 10] },
  surface: { kind: 'grating', period: 1.5, height: 0.13, orientation: 0.6 },
  material: { roughness: 0.03 },
  lights: [
    { kind: 'directional', direction: [0.35, 0.2, 1], angularRadius: 0.02, intensity: 2 },
    { kind: 'point', position: [-1, 1, 1], color: [1, 0.6, 0.4] },
  ],
}
/** Surfaces that are drawn in an environment too. */
const SURROUNDED = ['grating, blazed', 'foil of many gratings', 'relief of skin']

const foil = (name: string): SurfaceDescription => ({
  kind: 'foil',
  map: `/maps/baked/foil-${name}`,
  repeat: [2, 3],
})
const SURFACES: Record<string, [SurfaceDescription, SceneDescription['material']?]> = {
  ...Object.fromEntries(
    ['sinusoidal', 'rectangular', 'blazed', 'triangular', 'sampled'].map((profile) => [
      `grating, ${profile}`,
      [{ kind: 'grating', period: 1.5, height: 0.13, orientation: 0.6, profile }],
    ]),
  ),
  'grating in circles': [
    { kind: 'grating', period: 1.6, height: 0.12, tracks: 'circular', strength: 0.7 },
    {
      metal: 'copper',
      roughness: 0.02,
      coat: 0.8,
      coatIor: 1.6,
      coatRoughness: 0.2,
      color: [0.4, 0.1, 0.1],
    },
  ],
  'grating of a profile by address': [
    { kind: 'grating', period: 1.5, height: 0.1, profile: '/maps/baked/profile-blazed' },
    { illuminant: '/maps/baked/lobes-1931-2-A', metal: 'gold', roughness: 0.02 },
  ],
  'foil of few gratings': [foil('polygons')],
  'foil of many gratings': [foil('glitter'), { illuminant: 'LED-B3', roughness: 0.02 }],
  relief: [{ kind: 'height-field', field: 'cosine', orientation: 0.4 }],
  'relief of skin': [
    { kind: 'height-field', field: 'fingers', ior: 1.45, strength: 0.6 },
    { color: [0.3, 0.2, 0.1], roughness: 0.01 },
  ],
  'relief that is baked': [
    { kind: 'height-field', field: 'bumps' },
    { method: 'baked', roughness: 0.0175 },
  ],
}

/** Of the same program with the same numbers. */
function expectSame({ errors, type, moved, difference, largest }: GltfOutcome): void {
  expect(errors).toEqual([])
  expect(type).toBe('DiffractionMaterial')
  expect(moved).toBeLessThan(1e-6)
  expect(largest).toBeGreaterThan(0.1)
  expect(difference / largest).toBeLessThanOrEqual(1e-6)
}

const sceneOf = (name: string): SceneDescription => {
  const [surface, material = SCENE.material!] = SURFACES[name]!
  const environment = SURROUNDED.includes(name) ? { asset: 'studio' } : undefined
  return { ...SCENE, surface, material, ...(environment && { environment }) }
}

describe('the same picture', () => {
  it.each(Object.keys(SURFACES))('comes from a glb of a %s', async (name) => {
    expectSame(await pass({ scene: sceneOf(name), container: 'glb' }))
  })

  it.each(['grating, blazed', 'foil of few gratings', 'relief of skin'])(
    'comes from a gltf of a %s',
    async (name) => {
      expectSame(await pass({ scene: sceneOf(name), container: 'gltf' }))
    },
  )

  it.each<[string, GltfRequest['textures'], boolean, number]>([
    ['a base map', ['map'], false, 1e-6],
    ['a normal map and tangents', ['normalMap'], true, 1e-6],
    ['a bump map', ['bumpMap'], false, 1e-6],
    // three turns its green over in the file, and its scale in the material: texels are blended with other roundings.
    ['a normal map', ['normalMap'], false, 0.01],
  ])('comes from a surface with %s', async (_name, textures, tangents, most) => {
    const scene = sceneOf('grating in circles')
    const request = {
      scene: { ...scene, mesh: { ...scene.mesh, tangents } },
      container: 'glb',
    } as const
    const outcome = await pass({ ...request, textures })
    expect(outcome.errors).toEqual([])
    expect(outcome.difference / outcome.largest).toBeLessThanOrEqual(most)
    const bare = await pass(request)
    expect(Math.abs(bare.mean[0] - outcome.mean[0]) / bare.mean[0]).toBeGreaterThan(0.001)
  })
})

describe('another picture', () => {
  const scene = sceneOf('grating in circles')
  const changes: [string, (string | number)[], unknown][] = [
    ['a percent of the period', ['surface', 'period'], 1.6 * 1.01],
    ['a percent of the height', ['surface', 'height'], 0.12 * 1.01],
    ['straight tracks', ['surface', 'tracks'], undefined],
    ['no base', ['surface', 'strength'], undefined],
    ['another metal', ['metal'], 'gold'],
    ['no roughness', ['roughness'], undefined],
    ['no lacquer', ['coat'], undefined],
    ['another base', ['matteColorFactor', 0], 1],
  ]
  it.each(changes)('comes from a file with %s', async (_name, path, value) => {
    const outcome = await pass({ scene, container: 'gltf', change: { path, value } })
    expect(outcome.errors).toEqual([])
    expect(outcome.difference / outcome.largest).toBeGreaterThan(0.001)
  })

  it('comes from texture coordinates that are turned over', async () => {
    for (const name of ['grating, blazed', 'foil of few gratings', 'relief of skin']) {
      const outcome = await pass({ scene: sceneOf(name), container: 'glb', flipped: true })
      expect(outcome.difference / outcome.largest, name).toBeGreaterThan(0.005)
    }
  })
})

describe('without the plugin', () => {
  const plain = async (name: string): Promise<GltfOutcome> =>
    pass({ scene: sceneOf(name), container: 'glb', plugin: false })

  it('all surfaces of one metal and roughness look alike, and are lit', async () => {
    const [first, ...others] = [
      await plain('grating, sinusoidal'),
      await plain('foil of few gratings'),
      await plain('relief'),
    ]
    expect(first).toMatchObject({ type: 'MeshStandardMaterial', errors: [] })
    expect(Math.min(...first.mean)).toBeGreaterThan(0.1)
    for (const { mean } of others) expect(mean).toEqual(first.mean)
    // What diffracts does not look like that.
    expect(first.difference / first.largest).toBeGreaterThan(0.1)
  })

  it('gold is more yellow than aluminium, and skin is no mirror', async () => {
    const redness = ({ mean: [red, , blue] }: GltfOutcome): number => red / blue
    const aluminium = await plain('grating, sinusoidal')
    expect(
      redness(await plain('grating of a profile by address')) / redness(aluminium),
    ).toBeGreaterThan(2)
    const skin = await plain('relief of skin')
    expect(skin.type).toBe('MeshPhysicalMaterial')
    expect(skin.mean[0]).toBeLessThan(aluminium.mean[0] / 2)
  })
})
