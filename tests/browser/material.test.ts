import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { LightDescription, SceneDescription } from './harness/scene-description'
import { openHarness } from './open-harness.mjs'
import { dot, normalized, readScene, render, type HarnessHandle, type Vector } from './read-scene'

let harness: HarnessHandle

beforeAll(async () => {
  harness = await openHarness()
})

afterAll(async () => {
  await harness.close()
})

/** The exact Fresnel reflectance of a dielectric, by way of Snell's angle rather than the shader's formula. */
function fresnel(cosI: number, ior: number): number {
  const i = Math.acos(cosI)
  const t = Math.asin(Math.sin(i) / ior)
  if (i < 1e-4) return ((ior - 1) / (ior + 1)) ** 2
  const s = Math.sin(i - t) / Math.sin(i + t)
  const p = Math.tan(i - t) / Math.tan(i + t)
  return (s * s + p * p) / 2
}

/** A sphere that does not diffract. */
const matt: SceneDescription = {
  size: [48, 48],
  camera: { position: [0, 0, 4], fov_deg: 32 },
  mesh: { kind: 'sphere', radius: 1 },
  surface: { kind: 'grating', period: 1.6, height: 0.1, strength: 0 },
  material: { color: [0.8, 0.4, 0.2] },
}
const direction: Vector = normalized([1, 2, 3])
const sun: LightDescription = { kind: 'directional', direction, intensity: 2 }

it('draws every variant that three can ask for', async () => {
  const failures = await harness.page.evaluate(() => window.harness.drawVariants())
  expect(failures).toEqual({})
  expect(harness.complaints).toEqual([])
})

describe('the matt base', () => {
  it('is Lambertian', async () => {
    const rendering = await render(harness, { ...matt, lights: [sun] })
    for (const pixel of rendering.covered) {
      const cosI = Math.max(dot(rendering.vector('normal', pixel), direction), 0)
      const rgb = rendering.rgb(pixel)
      for (const [i, albedo] of [0.8, 0.4, 0.2].entries())
        expect(rgb[i]).toBeCloseTo((2 * cosI * albedo) / Math.PI, 5)
    }
  })

  it('returns its albedo in a white furnace', async () => {
    const rendering = await render(harness, { ...matt, environment: { constant: [1, 1, 1] } })
    for (const pixel of rendering.covered) expect(rendering.rgb(pixel)[0]).toBeCloseTo(0.8, 4)
  })

  it('and the grating share the surface by its strength', async () => {
    const scene = await readScene('plane-directional')
    const whole = await render(harness, scene)
    const half = await render(harness, {
      ...scene,
      surface: { ...scene.surface, strength: 0.5 } as SceneDescription['surface'],
      material: { color: [0, 0, 0] },
    })
    for (const pixel of whole.covered)
      for (const i of [0, 1, 2])
        expect(half.rgb(pixel)[i]).toBeCloseTo(0.5 * whole.rgb(pixel)[i]!, 3)
  })
})

describe('the lacquer', () => {
  it('reflects by the exact Fresnel equations', async () => {
    const rendering = await render(harness, {
      ...matt,
      material: { color: [0, 0, 0], coat: 1, coatIor: 1.6 },
      environment: { constant: [1, 2, 3] },
    })
    for (const pixel of rendering.covered) {
      const wo = normalized(rendering.vector('position', pixel).map((c) => -c) as Vector)
      const cosO = Math.min(Math.max(dot(rendering.vector('normal', pixel), wo), 0), 1)
      for (const i of [0, 1, 2])
        expect(rendering.rgb(pixel)[i]! / (i + 1)).toBeCloseTo(fresnel(cosO, 1.6), 3)
    }
  })

  it('lets light through by (1 − F) on the way in and again on the way out', async () => {
    // Light and viewer on opposite sides of the normal's plane, far from the mirror direction.
    const scene: SceneDescription = {
      ...matt,
      lights: [{ ...sun, direction: [0, 0, 1] }],
      material: { color: [1, 1, 1], coat: 1, coatIor: 1.5, coatRoughness: 0.05 },
    }
    const coated = await render(harness, scene)
    const bare = await render(harness, { ...scene, material: { color: [1, 1, 1] } })
    let compared = 0
    for (const pixel of coated.covered) {
      const normal = coated.vector('normal', pixel)
      const wo = normalized(coated.vector('position', pixel).map((c) => -c) as Vector)
      const [cosI, cosO] = [normal[2], dot(normal, wo)]
      // Away from the highlight in the middle, and off the edge.
      if (cosI > 0.9 || cosI < 0.2 || cosO < 0.1) continue
      const through = (1 - fresnel(cosI, 1.5)) * (1 - fresnel(cosO, 1.5))
      expect(coated.rgb(pixel)[0] / bare.rgb(pixel)[0]).toBeCloseTo(through, 2)
      compared++
    }
    expect(compared).toBeGreaterThan(300)
  })

  it.each<[string, Vector]>([
    ['head-on', [0, 0, 1]],
    ['aslant', [0, 0.8, 0.6]],
  ])('shows a light of some size %s as it is where it is smooth', async (_name, light) => {
    // A Gaussian light's radiance is E/(2π r²) exp(−θ²/2r²); a mirror returns F of it.
    const radius = 0.05
    const rendering = await render(harness, {
      ...matt,
      camera: { position: [light[0], -light[1], light[2]], fov_deg: 20 },
      mesh: { kind: 'plane', size: [4, 4] },
      material: { color: [0, 0, 0], coat: 1, coatIor: 1.5 },
      lights: [{ kind: 'directional', direction: light, angularRadius: radius }],
    })
    let compared = 0
    for (const pixel of rendering.covered) {
      const wo = normalized(rendering.vector('position', pixel).map((c) => -c) as Vector)
      const normal = rendering.vector('normal', pixel)
      const mirrored = wo.map((c, i) => 2 * dot(wo, normal) * normal[i]! - c) as Vector
      // The view space's normal is the plane's: the light is where the middle of the view is mirrored.
      const towards = [0, 0, 1].map((c, i) => 2 * normal[2] * normal[i]! - c) as Vector
      const angle = Math.acos(Math.min(dot(mirrored, towards), 1))
      if (angle > 3 * radius) continue
      const peak = fresnel(dot(wo, normal), 1.5) / (2 * Math.PI * radius ** 2)
      const expected = peak * Math.exp(-((angle / radius) ** 2) / 2)
      expect(Math.abs(rendering.rgb(pixel)[0] - expected)).toBeLessThan(0.01 * peak)
      compared++
    }
    expect(compared).toBeGreaterThan(300)
  })

  it('keeps the energy of a light in its highlight', async () => {
    // A plane seen from far away, lit from the viewer's side: over the plane the half vector crosses the lobe, and
    // ∫ L dω_o cosθ_o = F E, here as a sum over pixels of a pinhole camera.
    const rendering = await render(harness, {
      ...matt,
      size: [128, 128],
      camera: { position: [0, 0, 1], fov_deg: 40 },
      mesh: { kind: 'plane', size: [4, 4] },
      material: { color: [0, 0, 0], coat: 1, coatIor: 1.5, coatRoughness: 0.2 },
      lights: [{ kind: 'directional', direction: [0, 0, 1] }],
    })
    const pixelSize = (2 * Math.tan((20 * Math.PI) / 180)) / 128
    let sum = 0
    for (const pixel of rendering.covered) {
      const [x, y, z] = rendering.vector('position', pixel)
      const cos = -z / Math.hypot(x, y, z)
      sum += rendering.rgb(pixel)[0] * pixelSize ** 2 * cos ** 3 * cos
    }
    // The lobe has long tails: a few percent of it fall outside the picture.
    expect(sum).toBeGreaterThan(0.04 * 0.9)
    expect(sum).toBeLessThan(0.04 * 1.01)
  })
})

describe('the environment', () => {
  it('turns as three turns it, and has no seam', async () => {
    const scene: SceneDescription = {
      ...matt,
      size: [96, 96],
      material: { color: [0, 0, 0], coat: 1, coatIor: 1.5 },
      environment: { asset: 'sunrise', rotation_deg: [0, 70, 0], intensity: 2 },
    }
    const rendering = await render(harness, scene)
    const { width, height, data } = rendering.environment!
    const angle = (70 * Math.PI) / 180
    const texel = (column: number, row: number, i: number): number =>
      Math.max(data[4 * (row * width + (((column % width) + width) % width)) + i]!, 0)
    let [error, total] = [0, 0]
    for (const pixel of rendering.covered) {
      const n = rendering.vector('normal', pixel)
      const wo = normalized(rendering.vector('position', pixel).map((c) => -c) as Vector)
      const cosO = dot(n, wo)
      if (cosO < 0.2) continue
      const r = [0, 1, 2].map((i) => 2 * cosO * n[i]! - wo[i]!) as Vector
      // The environment turned by +70° about y: look it up in the direction turned back.
      const d = [
        Math.cos(angle) * r[0] - Math.sin(angle) * r[2],
        r[1],
        Math.sin(angle) * r[0] + Math.cos(angle) * r[2],
      ] as const
      const x = (Math.atan2(d[2], d[0]) / (2 * Math.PI) + 0.5) * width - 0.5
      const y = (Math.asin(Math.min(Math.max(d[1], -1), 1)) / Math.PI + 0.5) * height - 0.5
      const [column, row] = [Math.floor(x), Math.min(Math.max(Math.floor(y), 0), height - 2)]
      const [fx, fy] = [x - column, Math.min(Math.max(y - row, 0), 1)]
      for (const i of [0, 1, 2]) {
        const low = texel(column, row, i) * (1 - fx) + texel(column + 1, row, i) * fx
        const high = texel(column, row + 1, i) * (1 - fx) + texel(column + 1, row + 1, i) * fx
        const expected = 2 * fresnel(cosO, 1.5) * (low * (1 - fy) + high * fy)
        error += (rendering.rgb(pixel)[i]! - expected) ** 2
        total += expected ** 2
      }
    }
    // Filters of a GPU place texels to 1/256.
    expect(Math.sqrt(error / total)).toBeLessThan(0.01)
  })

  it('is blurred by roughness from none at all', async () => {
    // So many nodes that no share of an arc is as wide as a texel: a smooth surface reads whole levels, a rough one does not.
    const material = { environmentNodes: 60 }
    const scene: SceneDescription = {
      ...(await readScene('environment-warehouse')),
      size: [48, 48],
      material,
    }
    const difference = async (roughness: number): Promise<number> => {
      const rough = await render(harness, { ...scene, material: { ...material, roughness } })
      let [error, total] = [0, 0]
      rough.radiance.forEach((value, i) => {
        error += (value - smooth.radiance[i]!) ** 2
        total += smooth.radiance[i]! ** 2
      })
      return Math.sqrt(error / total)
    }
    const smooth = await render(harness, scene)
    // A tilt of 1/5000 of a texel.
    expect(await difference(1e-6)).toBeLessThan(1e-4)
    expect(await difference(0.02)).toBeGreaterThan(0.1)
  })
})

describe('several lights', () => {
  it('add up, each with its own angular radius', async () => {
    const scene = await readScene('sphere-three-lights')
    const lights = [
      ...scene.lights!,
      { kind: 'point', position: [1, -1, 3], intensity: 5, angularRadius: 0.05 },
      { kind: 'directional', direction: [1, 0, 2], angularRadius: 0.03 },
    ] satisfies LightDescription[]
    // Grey throughout: what is left out of the test is which basis spectra are read.
    const grey = lights.map((light) => ({ ...light, color: [1, 1, 1] as Vector }))
    const together = await render(harness, { ...scene, lights: grey })
    const apart = await Promise.all(
      grey.map((light) => render(harness, { ...scene, lights: [light] })),
    )
    let [error, total] = [0, 0]
    for (const pixel of together.covered)
      for (const i of [0, 1, 2]) {
        const sum = apart.reduce((value, single) => value + single.rgb(pixel)[i]!, 0)
        error += (together.rgb(pixel)[i]! - sum) ** 2
        total += sum ** 2
      }
    expect(total).toBeGreaterThan(0)
    expect(Math.sqrt(error / total)).toBeLessThan(1e-5)
  })

  it('take the material’s radius where they state none', async () => {
    const scene = await readScene('plane-directional')
    const light: LightDescription = { kind: 'directional', direction: [0.35, 0, 1] }
    const stated = await render(harness, { ...scene, lights: [{ ...light, angularRadius: 0.02 }] })
    const taken = await render(harness, {
      ...scene,
      lights: [light],
      material: { lightAngularRadius: 0.02 },
    })
    expect(taken.radiance).toEqual(stated.radiance)
  })
})

describe('gamut mapping', () => {
  it('keeps luminance, and leaves no channel negative', async () => {
    const scene = await readScene('plane-directional')
    const signed = await render(harness, scene)
    const mapped = await render(harness, { ...scene, material: { gamut: 'map' } })
    const luminance = ([r, g, b]: Vector): number => 0.2126 * r + 0.7152 * g + 0.0722 * b
    let outside = 0
    for (const pixel of signed.covered) {
      const [before, after] = [signed.rgb(pixel), mapped.rgb(pixel)]
      if (Math.min(...before) < 0) outside++
      expect(Math.min(...after)).toBeGreaterThanOrEqual(0)
      const y = Math.max(luminance(before), 0)
      // The coefficients above have four digits.
      expect(Math.abs(luminance(after) - y)).toBeLessThan(
        1e-3 * Math.max(...before.map(Math.abs)) + 1e-6,
      )
      if (Math.min(...before) >= 0) expect(after).toEqual(before)
    }
    expect(outside).toBeGreaterThan(10)
  })
})

it('reports a map that is missing, by its file', async () => {
  const scene: SceneDescription = { ...matt, material: { illuminant: 'candle' } }
  await expect(harness.renderScene(scene)).rejects.toThrow('/maps/baked/lobes-1931-2-candle.json')
})
