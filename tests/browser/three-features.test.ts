import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { Harness } from './harness/harness'
import { openHarness } from './open-harness.mjs'

let harness: Awaited<ReturnType<typeof openHarness>>

beforeAll(async () => {
  harness = await openHarness()
})

afterAll(async () => {
  await harness.close()
})

function expectSame(actual: readonly number[], expected: readonly number[]): void {
  actual.forEach((channel, i) => {
    expect(channel).toBeCloseTo(expected[i]!, 4)
  })
}

describe.each(['DiffractionMaterial', 'diffractionLayer'] as const)('%s', (drawn) => {
  let seen: Awaited<ReturnType<Harness['probeFeatures']>>

  beforeAll(async () => {
    seen = await harness.page.evaluate((what) => window.harness.probeFeatures(what), drawn)
  })

  it('shows the green first order of the light', () => {
    const [red, green, blue] = seen.plain
    expect(green).toBeGreaterThan(1)
    expect(green).toBeGreaterThan(red)
    expect(green).toBeGreaterThan(blue)
  })

  it('is dark in a shadow, and untouched beside one', () => {
    expectSame(seen['in shadow'], [0, 0, 0])
    expectSame(seen['beside a shadow'], seen.plain)
  })

  it('disappears in fog and behind a clipping plane', () => {
    // 0x336699 in linear sRGB, from the sRGB transfer function by hand.
    expectSame(seen['deep in fog'], [0.0331, 0.1329, 0.3185])
    expectSame(seen['clipped away'], [0, 0, 0])
  })

  it('is the same as an instance', () => {
    expectSame(seen['as an instance'], seen.plain)
  })

  it('is turned by bones and morph targets', () => {
    expect(seen['tilted by a third'][1]).toBeLessThan(0.01 * seen.plain[1])
    expectSame(seen['turned back by a bone'], seen.plain)
    expectSame(seen['turned back by a morph target'], seen.plain)
  })

  it('takes normals from triangles where it is told to', () => {
    expectSame(seen['flat shading'], seen.plain)
  })

  it('is turned by a normal map, and left by a flat one', () => {
    expectSame(seen['flat normal map'], seen.plain)
    // Tilted by a third of a radian, the order that reached the viewer is elsewhere.
    expect(seen['tilted normal map'][1]).toBeLessThan(0.01 * seen.plain[1])
  })

  it('returns the metal under a white environment, of either kind', () => {
    const [red, green, blue] = seen['white equirectangular environment']
    // Aluminium, 0.92 in the blue to 0.90 in the red.
    for (const channel of [red, green, blue]) {
      expect(channel).toBeGreaterThan(0.9)
      expect(channel).toBeLessThan(0.93)
    }
    expect(blue).toBeGreaterThan(red)
    expectSame(seen['white cube environment'], [red, green, blue])
  })
})
