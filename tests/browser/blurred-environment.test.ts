import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { PlanarFrame, PlanarStep } from './harness/planar'
import type { SceneDescription } from './harness/scene-description'
import { openHarness } from './open-harness.mjs'
import type { HarnessHandle } from './read-scene'

let harness: HarnessHandle

beforeAll(async () => {
  harness = await openHarness()
})

afterAll(async () => {
  await harness.close()
})

const roughness = 0.02
const ball: SceneDescription = {
  size: [24, 24],
  camera: { position: [0, 0.3, 3], fov_deg: 40 },
  mesh: { kind: 'sphere', radius: 0.9 },
  surface: { kind: 'grating', period: 1.66, height: 0.15, profile: 'blazed' },
  material: { roughness },
  environment: { asset: 'venice' },
}

async function draw(scene: SceneDescription, steps: PlanarStep[] = [{}]): Promise<PlanarFrame[]> {
  return harness.page.evaluate(([s, t]) => window.harness.drawPlanarFrames(s, t), [
    scene,
    steps,
  ] as const)
}

/** Largest difference of two frames over the brightest of the second. */
function difference(a: PlanarFrame, b: PlanarFrame): number {
  const largest = Math.max(...a.pixels.map((value, i) => Math.abs(value - b.pixels[i]!)))
  return largest / Math.max(...b.pixels)
}

it('is made once, for any turn, and again for another roughness', async () => {
  const steps: PlanarStep[] = [
    {},
    { rotation_deg: [10, 20, 0] },
    { environmentTurn: 1 },
    { roughness: 0.05 },
    {},
  ]
  const frames = await draw(ball, steps)
  expect(frames.map(({ blur }) => blur.included)).toEqual([true, true, true, true, true])
  expect(frames.map(({ inner }) => inner > 0)).toEqual([true, false, false, true, false])
  expect(frames.at(-1)!.programs).toBe(frames[0]!.programs)
  const [fresh] = await draw({
    ...ball,
    mesh: { ...ball.mesh, rotation_deg: [10, 20, 0] },
    environment: { asset: 'venice', rotation_deg: [0, 180 / Math.PI, 0] },
    material: { roughness: 0.05 },
  })
  expect(difference(frames.at(-1)!, fresh!)).toBeLessThan(1e-5)
  expect(difference(frames[2]!, fresh!)).toBeGreaterThan(0.02)
})

// The second is brighter than any half float.
it.each([1, 2e5])(
  'of one grey of %d is that grey, at the poles and the seam too',
  async (level) => {
    const material = { roughness: 0.1 }
    const constant: [number, number, number] = [level, level, level]
    const grey: SceneDescription = { ...ball, material, environment: { constant } }
    const [blurred] = await draw(grey)
    const [sharp] = await draw({ ...grey, material: { roughness: 0 } })
    expect(blurred!.blur.included).toBe(true)
    expect(sharp!.blur.included).toBe(false)
    expect(difference(blurred!, sharp!)).toBeLessThan(2e-3)
  },
)

it.each([0, 90, 180, 270])(
  'has no seam: turned by %i° with its viewer it is the same',
  async (degrees) => {
    const angle = (degrees * Math.PI) / 180
    const round = {
      ...ball,
      surface: { ...ball.surface, period: 0.1 } as SceneDescription['surface'],
    }
    const [still] = await draw(round)
    // A period below half a wavelength is a mirror, and does not mind which way its grooves run.
    const [turned] = await draw({
      ...round,
      camera: { position: [3 * Math.sin(angle), 0.3, 3 * Math.cos(angle)], fov_deg: 40 },
      environment: { asset: 'venice', rotation_deg: [0, degrees, 0] },
    })
    expect(difference(still!, turned!)).toBeLessThan(0.01)
  },
)

it('has the faces of a cube where the cube has them', async () => {
  // The mirror image alone, and blurs so small that only the edges between faces differ.
  const surface = { ...ball.surface, period: 0.1 } as SceneDescription['surface']
  const step: PlanarStep = { cube: true, environmentTurn: 1 }
  const [sharp, blurred] = await draw({ ...ball, surface }, [
    { ...step, roughness: 0 },
    { ...step, roughness: 0.02 },
  ])
  expect([sharp!.blur.included, blurred!.blur.included]).toEqual([false, true])
  const covered = sharp!.pixels.filter((_, i) => i % 4 === 3).filter((alpha) => alpha > 0).length
  const off = sharp!.pixels.map((value, i) => Math.abs(value - blurred!.pixels[i]!))
  const same = sharp!.pixels.filter(
    (_, i) => i % 4 === 3 && sharp!.pixels[i]! > 0 && Math.max(...off.slice(i - 3, i)) < 0.01,
  ).length
  // Mirrored along any axis 0.61 of them are the same at most.
  expect(same / covered).toBeGreaterThan(0.8)
})

describe('is left out', () => {
  it.each<[string, SceneDescription, string]>([
    ['of a smooth surface', { ...ball, material: {} }, 'roughness is 0'],
    ['of one that is hardly rough', { ...ball, material: { roughness: 0.003 } }, 'texel'],
    ['of the papers’ loop', { ...ball, material: { roughness, method: 'wavelength-loop' } }, 'mip'],
    ['without an environment', { ...ball, environment: undefined }, 'no env'],
    [
      'of a height field',
      { ...ball, surface: { kind: 'height-field', field: 'cosine' } },
      'mip levels',
    ],
    ['of a flat surface', { ...ball, mesh: { kind: 'plane', size: [1, 1] } }, 'table'],
  ])('%s', async (_name, scene, why) => {
    const [frame] = await draw(scene)
    expect(frame!.blur.included).toBe(false)
    expect(frame!.blur.why).toContain(why)
  })
})

it('complains of nothing', () => {
  expect(harness.complaints).toEqual([])
})
