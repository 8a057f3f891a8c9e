import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { MeshDescription, SceneDescription } from './harness/scene-description'
import { openHarness } from './open-harness.mjs'
import { cross, dot, render, type HarnessHandle, type Rendering } from './read-scene'

let harness: HarnessHandle

beforeAll(async () => {
  harness = await openHarness()
})

afterAll(async () => {
  await harness.close()
})

/** A surface whose grating vector is turned from the tangent, so that the bitangent's side shows too. */
function sceneOf(mesh: MeshDescription): SceneDescription {
  return {
    size: [48, 48],
    camera: { position: [0.4, 0.3, 4], fov_deg: 34 },
    mesh,
    surface: { kind: 'grating', period: 1.6, height: 0.1, orientation: 0.6 },
  }
}

/** Largest distance between the grating vectors of two renderings, over pixels both cover. */
function largestDifference(a: Rendering, b: Rendering): number {
  const covered = new Set(b.covered)
  let largest = 0
  for (const pixel of a.covered) {
    if (!covered.has(pixel)) continue
    const [p, q] = [a.vector('grating', pixel), b.vector('grating', pixel)]
    largest = Math.max(largest, Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]))
  }
  return largest
}

const sphere: MeshDescription = { kind: 'sphere', radius: 1 }
const plane: MeshDescription = { kind: 'plane', size: [2, 2], rotation_deg: [20, 30, 10] }
const turnedAway: MeshDescription = { ...plane, rotation_deg: [20, 200, 10] }

describe('the tangent frame', () => {
  it.each<[string, MeshDescription, number]>([
    ['a plane', plane, 1e-4],
    ['a stretched plane', { ...plane, scale: [1, 0.3, 1] }, 1e-4],
    ['a mirrored plane', { ...plane, scale: [-1, 1, 1] }, 1e-4],
    ['the back of a double-sided plane', { ...turnedAway, side: 'double' }, 1e-4],
    ['the back side of a plane', { ...turnedAway, side: 'back' }, 1e-4],
    ['the back of a mirrored plane', { ...turnedAway, side: 'double', scale: [1, -1, 1] }, 1e-4],
    // Vertex tangents are interpolated, derivatives are those of each flat triangle, here 1.4° across; at the poles,
    // where u turns about, triangles are too coarse to say more.
    ['a sphere', sphere, 0.03],
  ])('is the same from tangents and from derivatives, on %s', async (_name, mesh, tolerance) => {
    const derived = await render(harness, sceneOf(mesh))
    const given = await render(harness, sceneOf({ ...mesh, tangents: true }))
    expect(derived.covered.length).toBeGreaterThan(200)
    expect(largestDifference(derived, given)).toBeLessThan(tolerance)
  })

  it('is orthonormal, and faces the viewer', async () => {
    for (const mesh of [sphere, plane, { ...turnedAway, side: 'double' } as const]) {
      const rendering = await render(harness, sceneOf(mesh))
      for (const pixel of rendering.covered) {
        const [normal, grating] = [
          rendering.vector('normal', pixel),
          rendering.vector('grating', pixel),
        ]
        expect(dot(normal, normal)).toBeCloseTo(1, 5)
        expect(dot(grating, grating)).toBeCloseTo(1, 5)
        expect(dot(normal, grating)).toBeCloseTo(0, 5)
        // A sphere's outermost pixels see interpolated normals a little past the edge.
        expect(dot(normal, rendering.vector('position', pixel))).toBeLessThan(0.1)
      }
    }
  })

  it('turns round on the back, so that the grating vector keeps its place about the normal', async () => {
    const front = await render(harness, sceneOf({ ...plane, rotation_deg: [0, 0, 0] }))
    const back = await render(
      harness,
      sceneOf({ ...plane, rotation_deg: [0, 180, 0], side: 'double' }),
    )
    const pixel = 24 * 48 + 24
    const turned = (rendering: Rendering): number => {
      const tangent = rendering.vector('tangent', pixel)
      const across = cross(rendering.vector('normal', pixel), tangent)
      const grating = rendering.vector('grating', pixel)
      return Math.atan2(dot(across, grating), dot(tangent, grating))
    }
    // 0.6 rad from u towards v: anticlockwise in front, clockwise from behind.
    expect(turned(front)).toBeCloseTo(0.6, 4)
    expect(turned(back)).toBeCloseTo(-0.6, 4)
    // From behind, u grows to the left, and a relief's x runs against it: to the right, but for
    // the camera's being a little to the side.
    expect(back.vector('tangent', pixel)[0]).toBeGreaterThan(0.99)
  })

  it('is some frame, without NaN, where uv do not vary', async () => {
    for (const tangents of [false, true]) {
      const rendering = await render(harness, {
        ...sceneOf({ ...sphere, constantUv: true, tangents }),
        lights: [{ kind: 'directional', direction: [0, 0, 1], angularRadius: 0.1 }],
      })
      expect(rendering.geometry.every(Number.isFinite)).toBe(true)
      expect(rendering.radiance.every(Number.isFinite)).toBe(true)
      const grating = rendering.vector('grating', 24 * 48 + 24)
      expect(dot(grating, grating)).toBeCloseTo(1, 5)
    }
  })
})
