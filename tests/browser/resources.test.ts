import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { MaterialDescription, SurfaceDescription } from './harness/scene-description'
import { openHarness } from './open-harness.mjs'
import { floats, type HarnessHandle } from './read-scene'

let harness: HarnessHandle

beforeAll(async () => {
  harness = await openHarness()
})

afterAll(async () => {
  await harness.close()
})

/** Materials beside the first one: harness/resources.ts. */
const MORE = 3

type Options = Omit<MaterialDescription, 'color'>

const grating: SurfaceDescription = { kind: 'grating', period: 1.6, height: 0.1 }
const foil: SurfaceDescription = { kind: 'foil', map: '/maps/baked/foil-polygons' }
const glitter: SurfaceDescription = { kind: 'foil', map: '/maps/baked/foil-glitter' }
const bumps: SurfaceDescription = { kind: 'height-field', field: 'bumps', ior: 1.5 }

describe.each<[string, SurfaceDescription, Options]>([
  ['a grating', grating, {}],
  ['a rough grating', grating, { roughness: 0.02 }],
  ['a foil', foil, { roughness: 0.02 }],
  ['a foil of many gratings', glitter, { roughness: 0.02 }],
  ['a height field', bumps, {}],
  ['a height field by its series', bumps, { method: 'jacobi-anger' }],
])('%s', (_name, surface, options) => {
  it('leaves nothing behind, and shares its tables', async () => {
    const { before, during, after, uploads } = await harness.page.evaluate(
      ([what, how]) => window.harness.countResources(what, how),
      [surface, options] as const,
    )
    expect(during.textures).toBeGreaterThan(before.textures + 3)
    expect(during.programs).toBeGreaterThan(0)
    expect(after).toEqual(before)
    expect(uploads[0]).toBeGreaterThan(3)
    // Nodes of the environment are a material's own.
    expect(uploads[1] / MORE).toBeLessThanOrEqual(4)
    expect(harness.complaints).toEqual([])
  })
})

describe('a context that was lost', () => {
  it.each<[string, SurfaceDescription, Options, 'card' | 'sphere', boolean]>([
    ['a sharp grating', grating, {}, 'sphere', false],
    ['a table of the environment', grating, { roughness: 0.02 }, 'card', false],
    ['a blurred environment', grating, { roughness: 0.02 }, 'sphere', false],
    ['a foil', foil, {}, 'card', false],
    ['a foil of many gratings', glitter, {}, 'card', false],
    ['a height field', bumps, {}, 'sphere', false],
    ['frames at rest', grating, {}, 'sphere', true],
  ])('comes back with the same picture of %s', async (_name, surface, options, kind, refined) => {
    const { before, after, lit } = await harness.page.evaluate(
      (request) => window.harness.drawRestored(...request),
      [surface, options, kind, refined] as [
        SurfaceDescription,
        Options,
        'card' | 'sphere',
        boolean,
      ],
    )
    expect(lit).toBeGreaterThan(1000)
    expect(floats(after)).toEqual(floats(before))
  })
})
