import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { OpticsSettings } from '../../web'
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
    // The first has the nodes of its refinement since, and with them those of a single frame.
    expect(uploads[1]).toBeLessThanOrEqual(1)
    expect(harness.complaints).toEqual([])
  })
})

const shared: [string, SurfaceDescription][] = [
  ['a grating', grating],
  ['a foil', foil],
  ['a foil of many gratings', glitter],
  ['a height field', bumps],
]

describe.each(shared)('%s that ten materials and layers show', (_name, surface) => {
  it.each([
    ['first to last', [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]],
    ['last to first', [9, 8, 7, 6, 5, 4, 3, 2, 1, 0]],
    ['in no order', [4, 7, 0, 9, 2, 1, 8, 3, 6, 5]],
  ])('is uploaded once, and freed with the last of them, %s', async (_order, order) => {
    const { empty, first, all, rests } = await harness.page.evaluate(
      (request) => window.harness.countSharing(...request),
      [surface, order] as [SurfaceDescription, number[]],
    )
    const tables = first.textures - empty.textures
    expect(tables).toBeGreaterThan(3)
    expect(first.uploads).toBe(tables)
    const same = { textures: first.textures, uploads: 0 }
    expect(all).toEqual(same)
    expect(rests.slice(0, -1)).toEqual(Array.from({ length: 9 }, () => same))
    expect(rests.at(-1)).toEqual(empty)
    expect(harness.complaints).toEqual([])
  })
})

describe.each(shared.slice(1))('%s in the place of a grating', (_name, surface) => {
  it('is freed with the next frame once the grating is back, and so is what else is replaced', async () => {
    const { empty, gratings, one, both, oneBack, bothBack, later, gold, aluminium, redrawn, gone } =
      await harness.page.evaluate((what) => window.harness.countReplacing(what), surface)
    expect(gratings.uploads).toBe(gratings.textures - empty.textures)
    // Some tables are those of both surfaces.
    expect(one.textures).toBeGreaterThan(gratings.textures)
    expect(one.uploads).toBe(one.textures - gratings.textures)
    expect(both.textures).toBeLessThanOrEqual(one.textures)
    expect(both.uploads).toBe(0)
    expect(oneBack.uploads).toBe(oneBack.textures - both.textures)
    const before = { textures: gratings.textures, uploads: 0 }
    expect(bothBack).toEqual(before)
    expect(later).toEqual(before)
    expect(gold.textures).toBeGreaterThan(gratings.textures)
    expect(gold.uploads).toBe(gold.textures - gratings.textures)
    expect(aluminium).toEqual(before)
    expect(redrawn).toEqual(gratings)
    expect(gone).toEqual(empty)
    expect(harness.complaints).toEqual([])
  })
})

describe('a height field whose settings change', () => {
  it.each([
    ['metal', { metal: 'gold' }],
    ['nodes', { environmentNodes: 3 }],
  ] as const)('is drawn as before until samples for its %s are there', async (_name, settings) => {
    const { textures, ...pictures } = await harness.page.evaluate(
      (request) => window.harness.drawLate(...request),
      [{ ...bumps, ior: null }, settings] as [SurfaceDescription, Partial<OpticsSettings>],
    )
    const { before, meanwhile, after, fresh } = pictures
    expect(floats(before).filter((value) => value !== 0).length).toBeGreaterThan(1000)
    expect(meanwhile).toBe(before)
    expect(after).not.toBe(before)
    expect(after).toBe(fresh)
    // What was drawn before is freed.
    expect(textures[1]).toBe(textures[0])
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
