import { Euler, MathUtils, Matrix4 } from 'three'
import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import { fakeFoil, filesOf, STEEPEST } from '../web/fake-maps'
import type {
  LightDescription,
  MeshDescription,
  SceneDescription,
} from './harness/scene-description'
import { openHarness } from './open-harness.mjs'
import { normalized, render, Rendering, type HarnessHandle, type Vector } from './read-scene'

let harness: HarnessHandle

/** Texels of a slope: along u and along v. */
const LEAN: [number, number] = [172, 96]
/** The components along u and v over that along z that these stand for: 2.0° and −1.4°. */
const [P, Q] = LEAN.map((texel) => (STEEPEST * (texel - 128)) / 127) as [number, number]

/** Each texel of a foil is one of these, bytes of cos 2θ, sin 2θ, frequency, strength. */
const ONE_GRATING = [230, 60, 190, 255]
const many = Array.from({ length: 64 }, (_, i) => {
  const θ = (Math.PI * i) / 64
  return [127.5 + 127.5 * Math.cos(2 * θ), 127.5 + 127.5 * Math.sin(2 * θ), 190, 255]
})

/** Four by four slopes, no two alike. */
const HILLS = Array.from({ length: 16 }, (_, i) => [20 + 13 * i, 235 - ((29 * i) % 200)])

const image = (texels: number[][]): Uint8Array<ArrayBuffer> =>
  Uint8Array.from(texels.flat().map(Math.round))
const lean = { pixels: image([[...LEAN, 255, 255]]), size: [1, 1] as [number, number] }
const hills = {
  pixels: image(HILLS.map((texel) => [...texel, 255, 255])),
  size: [4, 4] as [number, number],
}

/** Each in a folder of its own: their images have one name. */
const FOILS = {
  '/fake/flat/foil': fakeFoil(image([ONE_GRATING]), [1, 1]),
  '/fake/leaning/foil': fakeFoil(image([ONE_GRATING]), [1, 1], lean),
  '/fake/hilly/foil': fakeFoil(image([ONE_GRATING]), [1, 1], hills),
  '/fake/flat-many/foil': fakeFoil(image(many), [8, 8]),
  '/fake/leaning-many/foil': fakeFoil(image(many), [8, 8], lean),
}

beforeAll(async () => {
  harness = await openHarness()
  const files = filesOf(FOILS)
  await harness.page.route('**/fake/**', (route) => {
    const body = files[new URL(route.request().url()).pathname]!
    return route.fulfill({ body: Buffer.from(body) })
  })
})

afterAll(async () => {
  await harness.close()
})

const LAMP: LightDescription = {
  kind: 'directional',
  direction: [0.05, 0.02, 1],
  angularRadius: 0.06,
}

function sceneOf(map: string, mesh: Partial<MeshDescription> = {}): SceneDescription {
  return {
    size: [24, 24],
    camera: { position: [0, 0, 4], fov_deg: 60 },
    mesh: { kind: 'plane', size: [40, 40], ...mesh } as MeshDescription,
    surface: { kind: 'foil', map: `/fake/${map}/foil` },
    lights: [LAMP],
  }
}

/** The mesh turned so that all of it leans by p along growing u and by q along growing v. */
function leaning(mesh: Partial<MeshDescription>, p: number, q: number): Partial<MeshDescription> {
  const [x = 0, y = 0, z = 0] = (mesh.rotation_deg ?? []).map(MathUtils.degToRad)
  const [mirrorU, mirrorV] = (mesh.scale ?? [1, 1, 1]).map(Math.sign) as Vector
  // About x first, then about the y that has come with it: u stays in the plane of the normal and itself.
  const tilt = new Euler(-Math.atan(mirrorV * q), Math.atan((mirrorU * p) / Math.hypot(1, q)), 0)
  const turned = new Matrix4()
    .makeRotationFromEuler(new Euler(x, y, z))
    .multiply(new Matrix4().makeRotationFromEuler(tilt))
  const euler = new Euler().setFromRotationMatrix(turned)
  const rotation = [euler.x, euler.y, euler.z].map(MathUtils.radToDeg) as Vector
  return { ...mesh, rotation_deg: rotation }
}

/** Largest distance between two renderings' vectors, over pixels both cover. */
function furthest(layer: 'normal' | 'grating', a: Rendering, b: Rendering): number {
  const covered = new Set(b.covered)
  const pixels = a.covered.filter((pixel) => covered.has(pixel))
  expect(pixels.length).toBeGreaterThan(200)
  const distances = pixels.map((pixel) => {
    const [p, q] = [a.vector(layer, pixel), b.vector(layer, pixel)]
    return Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2])
  })
  return Math.max(...distances)
}

/** Root of the mean square difference of radiance over that of the second. */
function apart(a: Rendering, b: Rendering): number {
  let [difference, whole] = [0, 0]
  b.radiance.forEach((value, i) => {
    if (i % 4 === 3) return
    difference += (a.radiance[i]! - value) ** 2
    whole += value ** 2
  })
  expect(whole).toBeGreaterThan(0)
  return Math.sqrt(difference / whole)
}

describe('a foil whose bumps all lean alike', () => {
  it.each<[string, Partial<MeshDescription>]>([
    ['a plane', {}],
    ['a plane with tangents', { tangents: true }],
    ['a plane aslant', { rotation_deg: [12, -20, 33] }],
    ['a stretched plane', { kind: 'plane', size: [60, 20] }],
    ['a stretched plane with tangents', { kind: 'plane', size: [60, 20], tangents: true }],
    ['a plane mirrored along u', { scale: [-1, 1, 1] }],
    ['a plane mirrored along v, with tangents', { scale: [1, -1, 1], tangents: true }],
    ['the back of a double-sided plane', { rotation_deg: [0, 170, 0], side: 'double' }],
    [
      'the back of a plane, with tangents',
      { rotation_deg: [0, 190, 0], side: 'back', tangents: true },
    ],
  ])('has the normals and gratings of a flat one on a mesh that leans: %s', async (_name, mesh) => {
    const bumpy = await render(harness, sceneOf('leaning', mesh))
    const leant = await render(harness, sceneOf('flat', leaning(mesh, P, Q)))
    expect(furthest('normal', bumpy, leant)).toBeLessThan(1e-5)
    // Tangents from derivatives are no better.
    expect(furthest('grating', bumpy, leant)).toBeLessThan(1e-3)
  })

  it('sends what that one sends', async () => {
    // With a lamp in a fixed direction a pixel's radiance depends on its ray and the surface's frame, not on its place. A mesh
    // that is turned has its corners rounded otherwise to the grid of pixels, so that rays are 1e-3 rad off.
    const bumpy = await render(harness, sceneOf('leaning'))
    const leant = await render(harness, sceneOf('flat', leaning({}, P, Q)))
    expect(apart(bumpy, leant)).toBeLessThan(0.02)
    // Were a sign wrong, u in the place of v, or nothing bent, it would show.
    for (const [p, q] of [
      [-P, Q],
      [P, -Q],
      [Q, P],
      [0, 0],
    ] as const) {
      const wrong = await render(harness, sceneOf('flat', leaning({}, p, q)))
      expect(apart(wrong, leant)).toBeGreaterThan(0.3)
    }
  })

  it.each<[string, Partial<SceneDescription['surface']>]>([
    ['unfiltered', { filtered: false }],
    // So many tiles that each pixel covers whole ones, whose mean is the same wherever it lies.
    ['of many gratings', { repeat: [9000, 9000] }],
  ])('does so %s', async (name, surface) => {
    const suffix = name === 'unfiltered' ? '' : '-many'
    const [bumpy, leant] = await Promise.all(
      [sceneOf(`leaning${suffix}`), sceneOf(`flat${suffix}`, leaning({}, P, Q))].map((scene) =>
        render(harness, {
          ...scene,
          surface: { ...scene.surface, ...surface } as typeof scene.surface,
        }),
      ),
    )
    expect(apart(bumpy!, leant!)).toBeLessThan(0.02)
  })

  it('goes over a normal map', async () => {
    const scene = sceneOf('leaning')
    const mapped = await render(harness, { ...scene, force: { normalMap: true } })
    expect(apart(mapped, await render(harness, scene))).toBeLessThan(1e-5)
  })
})

describe('bumps', () => {
  const slope = (texel: number): number => (STEEPEST * (texel - 128)) / 127

  /** Their normal at a place of the tile, by the mean of the four texels about it. */
  function normalAt(u: number, v: number): Vector {
    const [x, y] = [4 * u - 0.5, 4 * (1 - v) - 0.5]
    const [column, row] = [Math.floor(x), Math.floor(y)]
    const sum: Vector = [0, 0, 1]
    for (const [i, j] of [
      [0, 0],
      [1, 0],
      [0, 1],
      [1, 1],
    ] as const) {
      const weight = (1 - Math.abs(x - column - i)) * (1 - Math.abs(y - row - j))
      const texel = HILLS[4 * ((row + j + 4) % 4) + ((column + i + 4) % 4)]!
      sum[0] += weight * slope(texel[0]!)
      sum[1] += weight * slope(texel[1]!)
    }
    return normalized(sum)
  }

  /** Largest distance between the normals seen and those of `normalAt`. */
  async function off(repeat: [number, number]): Promise<number> {
    const rendering = await render(harness, {
      ...sceneOf('hilly', { kind: 'plane', size: [2, 2] }),
      surface: { kind: 'foil', map: '/fake/hilly/foil', repeat },
    })
    let largest = 0
    for (const pixel of rendering.covered) {
      const [x, y] = rendering.vector('position', pixel)
      const [u, v] = [(repeat[0] * (x + 1)) / 2, (repeat[1] * (y + 1)) / 2]
      const expected = normalAt(u - Math.floor(u), v - Math.floor(v))
      const normal = rendering.vector('normal', pixel)
      largest = Math.max(largest, Math.hypot(...normal.map((c, i) => c - expected[i]!)))
    }
    return largest
  }

  it('are where the map has them, half a texel from its edges, and repeat with the foil', async () => {
    // Texture units weigh texels by steps of 1/256.
    expect(await off([1, 1])).toBeLessThan(0.01 * STEEPEST)
    expect(await off([2, 1])).toBeLessThan(0.01 * STEEPEST)
    expect(await off([1, 1.5])).toBeLessThan(0.01 * STEEPEST)
  })

  it('that are finer than a pixel show their mean', async () => {
    const rendering = await render(harness, {
      ...sceneOf('hilly', { kind: 'plane', size: [2, 2] }),
      surface: { kind: 'foil', map: '/fake/hilly/foil', repeat: [300, 300] },
    })
    const mean = (i: number): number => HILLS.reduce((sum, texel) => sum + slope(texel[i]!), 0) / 16
    for (const pixel of rendering.covered) {
      const [x, y, z] = rendering.vector('normal', pixel)
      expect(Math.hypot(x / z - mean(0), y / z - mean(1))).toBeLessThan(0.01 * STEEPEST)
    }
  })

  it('are left out, with their texture, where the map has none', async () => {
    for (const [map, has] of [
      ['flat', false],
      ['leaning', true],
    ] as const) {
      const { fragmentShader, tables, explanation } = await harness.renderScene(sceneOf(map))
      expect(/#define FOIL_BUMPS/.test(fragmentShader)).toBe(has)
      expect(tables.some(({ uniform }) => uniform === 'uFoilNormal')).toBe(has)
      expect(explanation.find(({ feature }) => feature === 'bumps')?.included).toBe(has)
    }
  })

  it('rule out the table of a flat surface', async () => {
    const table = async (map: string): Promise<boolean | undefined> => {
      const { explanation } = await harness.renderScene({
        ...sceneOf(map),
        lights: [],
        environment: { constant: [1, 1, 1] },
        material: { roughness: 0.02 },
      })
      return explanation.find(({ feature }) => feature.startsWith('table of the'))?.included
    }
    expect(await table('flat')).toBe(true)
    expect(await table('leaning')).toBe(false)
  })
})
