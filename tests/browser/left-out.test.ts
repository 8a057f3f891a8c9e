import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { TransferredScene } from './harness/harness'
import type { ForcedParts, LightDescription, SceneDescription } from './harness/scene-description'
import { openHarness } from './open-harness.mjs'
import { render, Rendering, type HarnessHandle } from './read-scene'

let harness: HarnessHandle

beforeAll(async () => {
  harness = await openHarness()
})

afterAll(async () => {
  await harness.close()
})

const grating: SceneDescription = {
  size: [48, 48],
  camera: { position: [0, 0, 3], fov_deg: 40 },
  mesh: { kind: 'plane', size: [2, 2], rotation_deg: [-10, 5, 0] },
  surface: { kind: 'grating', period: 1.66, height: 0.15 },
  lights: [{ kind: 'directional', direction: [0.35, 0, 1], angularRadius: 0.0046 }],
}

const SCENES: Record<string, SceneDescription> = {
  grating,
  foil: {
    ...grating,
    surface: { kind: 'foil', map: '/maps/baked/foil-polygons', repeat: [8, 8] },
    material: { roughness: 0.02, color: [0.2, 0.1, 0.1] },
  },
  relief: { ...grating, surface: { kind: 'height-field', field: 'cosine' } },
  surroundings: { ...grating, lights: [], environment: { asset: 'studio' } },
}

/** Nothing in a sum of floats; what is wholly dark the shader would skip. */
const LIGHT: LightDescription = {
  kind: 'directional',
  direction: [0.3, 0.1, 1],
  intensity: 1e-30,
}
const ENVIRONMENT = { asset: 'studio', intensity: 0 }

/** What can be forced in, by the name under which the material says that it left it out. */
const PARTS: Record<string, ForcedParts> = {
  lights: { lights: [LIGHT] },
  'tinted light': { defines: { TINTED: '' } },
  'equirectangular environment': { environment: ENVIRONMENT },
  lacquer: { defines: { COAT: '' } },
  'matt base': { defines: { BASE: '' } },
  normalMap: { normalMap: true },
  'wide lobes of all orders': { defines: { WIDE_LOBES: '' } },
}

/** Largest difference of any channel over the largest channel. */
function difference(forced: TransferredScene, plain: TransferredScene): number {
  const [a, b] = [new Rendering(forced).radiance, new Rendering(plain).radiance]
  let [apart, largest] = [0, 0]
  b.forEach((value, i) => {
    apart = Math.max(apart, Math.abs(a[i]! - value))
    if (i % 4 < 3) largest = Math.max(largest, Math.abs(value))
  })
  expect(largest).toBeGreaterThan(0)
  return apart / largest
}

describe.each(Object.entries(SCENES))('what a scene leaves out: %s', (_name, scene) => {
  it('would change no pixel', async () => {
    const plain = await harness.renderScene(scene)
    const leftOut = plain.explanation.filter(({ included }) => !included)
    const parts = leftOut.filter(({ feature }) => feature in PARTS)
    expect(parts.length).toBeGreaterThan(2)
    for (const { feature } of parts) {
      const forced = await harness.renderScene({ ...scene, force: PARTS[feature]! })
      expect(forced.fragmentShader, feature).not.toBe(plain.fragmentShader)
      // Ten times what float32 leaves of a lobe's exponent, of about ten.
      expect.soft(difference(forced, plain), feature).toBeLessThan(1e-5)
    }
  })
})

it('skips a light that is dark', async () => {
  const scene = { ...grating, surface: { ...grating.surface, strength: 0.5 } } as SceneDescription
  const dark = { ...scene, force: { lights: [{ ...LIGHT, intensity: 0 }] } }
  const [with0, without] = [await render(harness, dark), await render(harness, scene)]
  expect(with0.radiance).toEqual(without.radiance)
})

describe('orders that take less than 1/10000 of the light', () => {
  // Up to ±15 propagate, those beyond ±5 take next to nothing.
  const scene: SceneDescription = {
    ...SCENES.surroundings!,
    surface: { kind: 'grating', period: 3, height: 0.15 },
  }
  const ordersUpTo = (order: string): SceneDescription => ({
    ...scene,
    force: { defines: { MAX_ORDER: order } },
  })

  it('would change no pixel by more', async () => {
    const plain = await harness.renderScene(scene)
    const said = plain.explanation.map(({ feature }) => feature)
    expect(said).toContain('orders beyond ±5')
    const all = await harness.renderScene(ordersUpTo('TABLE_ORDER'))
    expect(difference(all, plain)).toBeGreaterThan(0)
    expect(difference(all, plain)).toBeLessThan(1e-4)
    // Two orders fewer would be seen.
    const fewer = await harness.renderScene(ordersUpTo('3'))
    expect(difference(fewer, plain)).toBeGreaterThan(1e-3)
  })
})

describe('tables', () => {
  const tablesOf = async (scene: SceneDescription): Promise<string[]> =>
    (await harness.renderScene(scene)).tables.map(({ uniform }) => uniform)

  it('of lights are not in the program of a scene that has none', async () => {
    const { surface } = SCENES.relief!
    const around = SCENES.surroundings!
    expect(await tablesOf(around)).toEqual(['uEfficiencyTable', 'uEnvironmentNodes'])
    expect(await tablesOf({ ...around, surface })).toEqual(['uEnvironmentSamples'])
  })

  it('of an environment neither', async () => {
    expect(await tablesOf(grating)).toEqual(['uEfficiencyTable', 'uLobeTable', 'uLightNodes'])
    expect(await tablesOf(SCENES.relief!)).not.toContain('uEnvironmentSamples')
  })
})
