import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { SurfaceDescription } from './harness/scene-description'
import type { Drawn } from './harness/three-features'
import { openHarness } from './open-harness.mjs'
import type { HarnessHandle } from './read-scene'

let harness: HarnessHandle

beforeAll(async () => {
  harness = await openHarness()
})

afterAll(async () => {
  await harness.close()
})

/** Changes back to what was drawn before, or to what needs no other program. */
const FAMILIAR = [
  'a light goes dark',
  'and bright',
  'and shown',
  'another red',
  'and white',
  'and none',
  'and goes',
  'gives way to another',
  'and goes again',
  'no longer',
  'a sharp one',
  'bare',
  'and the first again',
  'an object comes',
  'and one with a material of its own',
  'they go',
]

describe.each<[string, SurfaceDescription, Drawn?]>([
  ['a grating', { kind: 'grating', period: 1.6, height: 0.1, strength: 0.5 }],
  ['a foil', { kind: 'foil', map: '/maps/baked/foil-polygons' }],
  ['a foil of many gratings', { kind: 'foil', map: '/maps/baked/foil-glitter' }],
  ['a height field', { kind: 'height-field', field: 'cosine' }],
  ['a layer', { kind: 'foil', map: '/maps/baked/foil-polygons' }, 'diffractionLayer'],
])('the programs of %s', (_name, surface, drawn = 'DiffractionMaterial') => {
  it('are compiled once for each class of scene, and never again', async () => {
    const { compilations, programs } = await harness.page.evaluate(
      ([description, by]) => window.harness.countCompilations(description, by),
      [surface, drawn] as const,
    )
    const linked = compilations.reduce((sum, { first }) => sum + first, 0)
    expect(linked).toBeGreaterThan(5)
    expect(programs).toEqual(programs.map(() => linked))
    for (const { change, first, later } of compilations) {
      expect.soft(first, change).toBeLessThanOrEqual(FAMILIAR.includes(change) ? 0 : 1)
      expect.soft(later, `${change}, again`).toBe(0)
    }
    expect(harness.complaints).toEqual([])
  })
})
