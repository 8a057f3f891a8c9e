import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { PlanarFrame, PlanarStep } from './harness/planar'
import type { MeshDescription, SceneDescription } from './harness/scene-description'
import { openHarness } from './open-harness.mjs'
import type { HarnessHandle } from './read-scene'

let harness: HarnessHandle

beforeAll(async () => {
  harness = await openHarness()
})

afterAll(async () => {
  await harness.close()
})

/** Against the reference both are less than a percent off. */
const NODES_ERROR = 0.015

/** A degree. */
const roughness = 0.01745
/** A grating without symmetry, turned from the tangent, on a card that is turned from the viewer. */
const card: SceneDescription = {
  size: [32, 24],
  camera: { position: [0, 0.3, 2], fov_deg: 40 },
  mesh: { kind: 'plane', size: [2, 1.4], rotation_deg: [-20, 30, 10] },
  surface: { kind: 'grating', period: 1.66, height: 0.15, profile: 'blazed', orientation: 0.6 },
  material: { roughness, color: [0, 0, 0] },
  environment: { asset: 'venice' },
}

async function draw(scene: SceneDescription, steps: PlanarStep[] = [{}]): Promise<PlanarFrame[]> {
  return harness.page.evaluate(([s, t]) => window.harness.drawPlanarFrames(s, t), [
    scene,
    steps,
  ] as const)
}

/** The same by the nodes at every pixel. */
function byNodes(scene: SceneDescription): SceneDescription {
  return { ...scene, material: { ...scene.material, planarEnvironment: false } }
}

function withMesh(mesh: Partial<MeshDescription>): SceneDescription {
  return { ...card, mesh: { ...card.mesh, ...mesh } as MeshDescription }
}

/** Relative root mean square difference of two frames. */
function difference(a: PlanarFrame, b: PlanarFrame): number {
  let [sum, total] = [0, 0]
  a.pixels.forEach((value, i) => {
    sum += (value - b.pixels[i]!) ** 2
    total += i % 4 === 3 ? 0 : b.pixels[i]! ** 2
  })
  expect(total).toBeGreaterThan(0)
  return Math.sqrt(sum / total)
}

describe('the table of a flat surface', () => {
  it.each<[string, SceneDescription]>([
    ['a grating', card],
    [
      'a foil',
      {
        ...card,
        surface: { kind: 'foil', map: '/maps/baked/foil-polygons', repeat: [0.25, 0.25] },
      },
    ],
    ['a mirrored card', withMesh({ scale: [-1, 1, 1] })],
    ['a stretched card', withMesh({ scale: [1, 0.4, 1] })],
    ['a card turned inside out', withMesh({ scale: [1, 1, -1], rotation_deg: [-20, 210, 10] })],
    ['the back of a card', withMesh({ side: 'double', rotation_deg: [-20, 210, 10] })],
    ['the back side of a card', withMesh({ side: 'back', rotation_deg: [-20, 210, 10] })],
    ['a card with tangents', withMesh({ tangents: true })],
    ['a mirrored card with tangents', withMesh({ tangents: true, scale: [1, -1, 1] })],
    ['a disc', withMesh({ kind: 'disc', inner: 0.3, outer: 0.7 })],
    [
      'a turned environment',
      { ...card, environment: { asset: 'venice', rotation_deg: [20, 70, 0] } },
    ],
    ['a brighter environment', { ...card, environment: { asset: 'venice', intensity: 3 } }],
  ])('shows what the nodes show, on %s', async (_name, scene) => {
    const [table] = await draw(scene)
    const [nodes] = await draw(byNodes(scene))
    expect(table!.why).toContain('the mesh is flat')
    expect(table!.included).toBe(true)
    expect(nodes!).toMatchObject({ included: false, why: 'planarEnvironment is false' })
    expect(difference(table!, nodes!)).toBeLessThan(NODES_ERROR)
  })

  it.each<[string, SceneDescription, string]>([
    ['a sphere', withMesh({ kind: 'sphere', radius: 0.7 }), 'not one plane'],
    ['constant uv', withMesh({ constantUv: true }), 'not one plane'],
    ['a sharp grating', { ...card, material: { roughness: 0 } }, 'roughness'],
    [
      'circular tracks',
      { ...card, surface: { kind: 'grating', period: 1.66, height: 0.15, tracks: 'circular' } },
      'the same everywhere',
    ],
    ['the seed’s loop', { ...card, material: { roughness, method: 'wavelength-loop' } }, 'method'],
    ['flat shading', { ...card, material: { roughness, flatShading: true } }, 'flatShading'],
  ])('is left out for %s', async (_name, scene, why) => {
    const [frame] = await draw(scene)
    expect(frame!.included).toBe(false)
    expect(frame!.why).toContain(why)
    const [nodes] = await draw(byNodes(scene))
    expect(frame!.pixels).toEqual(nodes!.pixels)
  })
})

describe('a card that turns', () => {
  const turned: [number, number, number] = [15, -25, 40]

  it('has the nodes until it rests, then a table of its own, and compiles none after that', async () => {
    const steps = [{}, { rotation_deg: turned }, {}, {}, {}, {}]
    const frames = await draw(card, steps)
    expect(frames.map(({ included }) => included)).toEqual([true, false, false, true, true, true])
    const scene = withMesh({ rotation_deg: turned })
    const [fresh] = await draw(scene)
    const [nodes] = await draw(byNodes(scene))
    expect(difference(frames[1]!, nodes!)).toBeLessThan(1e-6)
    expect(difference(frames[3]!, fresh!)).toBeLessThan(1e-6)
    expect(frames[5]!.pixels).toEqual(frames[3]!.pixels)
    // One program each draws the card by table and by nodes, two fill the layers that the nodes read.
    expect(frames[1]!.programs - frames[0]!.programs).toBe(3)
    expect(frames[5]!.programs).toBe(frames[1]!.programs)
    expect(frames.map(({ inner }) => inner > 0)).toEqual([true, true, false, true, false, false])
  })

  it('reads no table while it turns', async () => {
    const frames = await draw(
      card,
      [0, 5, 10, 15].map((x) => ({ rotation_deg: [x, 0, 0] })),
    )
    // In the second frame the layers that the nodes read.
    expect(frames.map(({ inner }) => inner > 0)).toEqual([true, true, false, false])
    expect(frames.map(({ included }) => included)).toEqual([true, false, false, false])
  })
})

describe('another', () => {
  it.each<[string, PlanarStep, SceneDescription]>([
    [
      'turn of the environment',
      { environmentTurn: 1 },
      { ...card, environment: { asset: 'venice', rotation_deg: [0, 180 / Math.PI, 0] } },
    ],
    [
      'roughness',
      { roughness: 0.03 },
      { ...card, material: { ...card.material, roughness: 0.03 } },
    ],
    [
      'orientation',
      { orientation: 1.2 },
      { ...card, surface: { ...card.surface, orientation: 1.2 } as SceneDescription['surface'] },
    ],
  ])('%s makes another table', async (_name, step, scene) => {
    const frames = await draw(card, [{}, step, {}, {}])
    const [fresh] = await draw(scene)
    expect(frames.map(({ included }) => included)).toEqual([true, false, false, true])
    expect(difference(frames[0]!, fresh!)).toBeGreaterThan(0.02)
    expect(difference(frames[3]!, fresh!)).toBeLessThan(1e-5)
  })
})

it('shows two planes of one material by the nodes, and one of them alone by a table again', async () => {
  const companion = { position: [0.5, 0, 0.3], rotation_deg: [40, -30, 0], scale: [0.4, 0.4, 0.4] }
  const steps = [{ companion }, {}, {}, {}, { companion: null }, {}, {}, {}] as PlanarStep[]
  const frames = await draw(card, steps)
  const nodes = await draw(byNodes(card), steps)
  for (const i of [1, 2, 3]) {
    expect(frames[i]!.inner).toBe(0)
    expect(frames[i]!.pixels).toEqual(nodes[i]!.pixels)
  }
  expect(frames.at(-1)!.included).toBe(true)
  expect(difference(frames.at(-1)!, nodes.at(-1)!)).toBeLessThan(NODES_ERROR)
})

it('leaves the frame in which it is made as it found it', async () => {
  const [made, next] = await draw(card, [{}, {}])
  expect(made!.inner).toBeGreaterThan(0)
  expect(next!.inner).toBe(0)
  expect(made!.pixels).toEqual(next!.pixels)
  // 0x336699 in linear sRGB, from the sRGB transfer function by hand: drawn after the card, in the same viewport.
  const square = [0.0331, 0.1329, 0.3185]
  const seen = made!.pixels.some((_, i) =>
    square.every((channel, c) => i % 4 === 0 && Math.abs(made!.pixels[i + c]! - channel) < 1e-3),
  )
  expect(seen).toBe(true)
  expect(harness.complaints).toEqual([])
})
