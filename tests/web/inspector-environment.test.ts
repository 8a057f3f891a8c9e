import { Color, Euler, Matrix4, Mesh, Vector2, Vector3, type DataTexture } from 'three'
import { afterAll, beforeAll, describe, expect, it, vi } from 'vitest'
import { coatHighlight, coatMirror } from '../../demo/inspector/optics/coat'
import { efficiencyOf } from '../../demo/inspector/optics/efficiency'
import { EnvironmentLight } from '../../demo/inspector/optics/environment-light'
import { fresnel } from '../../demo/inspector/optics/fresnel'
import type { GratingOptics } from '../../demo/inspector/optics/grating-brdf'
import { bentFrame } from '../../demo/inspector/optics/foil-bumps'
import { gratingUnderEnvironment } from '../../demo/inspector/optics/grating-environment'
import { linePowers } from '../../demo/inspector/optics/line-powers'
import { LightSpectrum, type Colour } from '../../demo/inspector/optics/light-spectrum'
import type { Direction } from '../../demo/inspector/optics/orders'
import { Relief, type ReliefOptics } from '../../demo/inspector/optics/relief'
import { reliefUnderEnvironment } from '../../demo/inspector/optics/relief-environment'
import type { PickedPoint } from '../../demo/inspector/picked-point'
import { loadTables, pointOptics } from '../../demo/inspector/point-optics'
import { environmentRadiance, flashRadiance } from '../../demo/inspector/radiance'
import type { Subject } from '../../demo/subjects/subject'
import { Foil } from '../../web'
import { TiltedEnvironment } from '../../demo/inspector/optics/tilted-environment'
import { loadMap, type LoadedMap } from '../../web/maps/load'
import { maxOrder } from '../../web/spectrum/max-order'
import { metalReflectance } from '../../web/spectrum/metal-reflectance'
import { serveBakedMaps } from './baked-maps'
import { loadedEnvironment, madeEnvironment, texelFile } from './environments'
import { python } from './python'
import { atOnce } from '../../web/steps'

// Python starts for each, and sums up many tilts.
vi.setConfig({ testTimeout: 300_000 })

let metals: LoadedMap
let profile: LoadedMap
let spectrum: LightSpectrum

beforeAll(async () => {
  serveBakedMaps()
  metals = await loadMap('maps/baked/metals')
  profile = await loadMap('maps/baked/profile-sinusoidal')
  spectrum = new LightSpectrum(await loadMap('maps/baked/lobes-1931-2-D65'))
})

afterAll(() => {
  vi.unstubAllGlobals()
})

type Axes = [Vector3, Vector3, Vector3]

/** ω_o, and how the surface lies. */
interface Point {
  wo: Direction
  axes: Axes
}

/** Views from the normal to 60° off it, of surfaces that lie this way and that. */
const POINTS: Point[] = [
  [0, 0],
  [20, 20],
  [40, 200],
  [60, 100],
].map(([tilt, turn], k) => {
  const [θ, φ] = [(tilt! * Math.PI) / 180, (turn! * Math.PI) / 180]
  const frame = new Matrix4().makeRotationFromEuler(new Euler(0.3 * k - 1, 0.4 * k, 0.5))
  return {
    wo: [Math.sin(θ) * Math.cos(φ), Math.sin(θ) * Math.sin(φ), Math.cos(θ)],
    axes: [0, 1, 2].map((c) => new Vector3().setFromMatrixColumn(frame, c)) as Axes,
  }
})

/** The environment is turned about the vertical. */
const TURN = new Euler(0, 0.7, 0)

function lightOf(texture: DataTexture): EnvironmentLight {
  return new EnvironmentLight(texture, TURN, 1)
}

function gratingOf(roughness: number): GratingOptics {
  return {
    ...{ period: 1.66, height: 0.15, energy: 'conserving', coherence: 16.25, roughness },
    efficiency: efficiencyOf(profile),
    maxOrder: maxOrder(profile, 1.66, 0.15),
    reflectance: metalReflectance(metals, 'aluminium'),
  }
}

/** The colour of what is seen of an environment at every `stride`-th wavelength, each of which stands for as many. */
function colourOf(seen: Float64Array, stride = 1): Colour {
  return spectrum.colour(
    spectrum.wavelengths.map((_, cell) =>
      [0, 1, 2].reduce(
        (sum, tint) =>
          sum + stride * (seen[(3 * cell) / stride + tint] ?? 0) * spectrum.basis(cell, tint),
        0,
      ),
    ),
  )
}

/** The reference's linear sRGB at the points; `program` sets xyz from wo, sky, frame, light and its own input. */
async function reference(
  texture: DataTexture,
  name: string,
  program: string,
  own: unknown,
): Promise<Colour[]> {
  const toTexture = new Matrix4().makeRotationFromEuler(TURN).transpose()
  const points = POINTS.map(({ wo, axes }) => ({
    wo,
    frame: axes.map((axis) => axis.clone().applyMatrix4(toTexture).toArray()),
  }))
  const { width, height } = texture.image as { width: number; height: number }
  return (await python(
    `
import numpy as np
from precompute.gratings import Light
from precompute.renderings import _Equirectangular
from precompute.spectra import WAVELENGTHS, xyz_to_linear_srgb
points, file, size, own = input
texels = np.fromfile(file, np.float32).reshape(*size, 4)[..., :3].astype(float)
sky = _Equirectangular(np.maximum(texels, 0), 1)
wo, frame = (np.array([p[k] for p in points]) for k in ("wo", "frame"))
light = Light()
${program}
print(json.dumps((xyz @ xyz_to_linear_srgb("1931-2", "D65").T).tolist()))`,
    [points, await texelFile(texture, name), [height, width], own],
  )) as Colour[]
}

/** Root of the mean square distance of two lists of colours, over that of the second's length: the report's measure. */
function rms(found: readonly Colour[], expected: readonly Colour[]): number {
  const off = found.flatMap((rgb, i) => rgb.map((value, c) => value - expected[i]![c]!))
  return Math.hypot(...off) / Math.hypot(...expected.flat())
}

/** Largest distance of two lists of colours, over the second's length. */
function apart(found: readonly Colour[], expected: readonly Colour[]): number {
  const distances = found.map(
    (rgb, i) =>
      Math.hypot(...rgb.map((value, c) => value - expected[i]![c]!)) / Math.hypot(...expected[i]!),
  )
  return Math.max(...distances)
}

describe('a grating in an environment', () => {
  // The reference follows tilts to 3 standard deviations along either axis, which beside a lamp is 5 % short: here to 4.5.
  const GRATING = `
import precompute.reference
from precompute.gratings import Grating
nodes, flat = precompute.reference._tilt_nodes, own == 0
def wider(count):
    offsets = 1.5 * nodes(count)[0]
    shares = np.exp(-np.sum(offsets**2, axis=-1) / 2)
    return offsets, shares / shares.sum()
precompute.reference._tilt_nodes = nodes if flat else wider
grating = Grating(period=1.66, height=0.15, profile="sinusoidal", roughness=own)
xyz = precompute.reference.environment_radiance(
    grating, wo, sky, light, WAVELENGTHS[::STRIDE], tilts=41, frame=frame
)`
  const STRIDE = 40

  it.each([
    ['warehouse', 0.0122, 5e-3],
    ['warehouse', 0.007, 5e-3],
    ['studio', 0.0122, 5e-3],
    ['warehouse', 0, 1e-3],
  ])('of %s is the reference’s at a roughness of %f rad', async (name, roughness, most) => {
    const texture = await loadedEnvironment(name)
    const light = lightOf(texture)
    const wavelengths = spectrum.wavelengths.filter((_, cell) => cell % STRIDE === 0)
    const found = POINTS.map(({ wo, axes }) => {
      const around = light.around(axes)
      return colourOf(
        gratingUnderEnvironment(gratingOf(roughness), wo, wavelengths, around),
        STRIDE,
      )
    })
    const expected = await reference(
      texture,
      name,
      GRATING.replace('STRIDE', String(STRIDE)),
      roughness,
    )
    expect(apart(found, expected)).toBeLessThan(most)
  })

  it.each([0, 0.007, 0.0122, 0.08])(
    'reflects a white one as its metal does, roughness %f',
    (roughness) => {
      const light = lightOf(madeEnvironment(64, () => [1, 1, 1]))
      const grating = gratingOf(roughness)
      const grazing: Direction = [0.6, 0.79, Math.sqrt(1 - 0.6 ** 2 - 0.79 ** 2)]
      for (const { wo, axes } of [...POINTS, { ...POINTS[0]!, wo: grazing }]) {
        const seen = gratingUnderEnvironment(grating, wo, spectrum.wavelengths, light.around(axes))
        spectrum.wavelengths.forEach((wavelength, cell) => {
          expect(seen[3 * cell + 1]).toBeCloseTo(grating.reflectance(wavelength), 4)
        })
      }
    },
  )
})

describe('tilts', () => {
  it.each([true, false])(
    'are summed up, and held at the horizon; along a line alone: %s',
    (isLine) => {
      // Much brighter on one side.
      const light = new EnvironmentLight(
        madeEnvironment(256, (x, y, z) => [Math.exp(3 * x), Math.exp(2 * y), Math.exp(-3 * z)]),
        new Euler(),
        1,
      )
      const { wo, axes } = POINTS[1]!
      const roughness = 0.03
      const around = light.around(axes)
      const tilted = new TiltedEnvironment(around, wo, roughness, isLine)
      const most = Math.sqrt(1 - wo[1] ** 2)
      for (const x of [-0.995, -0.97, -0.6, 0.1, 0.9, 0.98].map((part) => part * most)) {
        const y = -wo[1]
        const found = new Float64Array(3)
        tilted.add(x, y, 1, found, 0)
        const deviation = roughness * (wo[2] + Math.sqrt(1 - x * x - y * y))
        const expected = new Float64Array(4)
        for (let i = -60; i <= 60; i++)
          for (let j = -60; j <= 60; j++) {
            const share = Math.exp(-0.5 * ((i / 15) ** 2 + (j / 15) ** 2))
            const [a, b] = [x + (deviation * i) / 15, y + (deviation * j) / 15]
            const held = Math.max(Math.hypot(a, b), 1)
            const up = Math.sqrt(Math.max(1 - (a * a + b * b) / held ** 2, 0))
            around.add(a / held, b / held, up, share, expected, 0)
            expected[3]! += share
          }
        for (let c = 0; c < 3; c++)
          expect(found[c]! / (expected[c]! / expected[3]!)).toBeCloseTo(1, 2)
      }
    },
  )
})

describe('a height field in an environment', () => {
  const FIELD = `
from pathlib import Path
from precompute.height_fields.environment import environment_radiance
from precompute.height_fields.optics import HeightFieldOptics
from precompute.height_fields.prepare import prepared
from precompute.height_fields.recipe import HeightFieldRecipe
name, roughness = own
recipe = Path(f"maps/recipes/height-field-{name}.json").read_text()
field = prepared(HeightFieldRecipe.model_validate_json(recipe), Path("maps/recipes"))
optics = HeightFieldOptics(metal="gold", roughness=roughness)
xyz = environment_radiance(field, optics, wo, sky, light, frame=frame)`

  async function fieldOf(name: string, roughness: number): Promise<ReliefOptics> {
    return {
      relief: new Relief(await loadMap(`maps/baked/height-field-${name}-jacobi-anger`)),
      reflectance: metalReflectance(metals, 'gold'),
      isRelative: false,
      coherence: 16.25,
      roughness,
    }
  }

  it.each([
    // Its map has amplitudes to 5e-4 of all light: faint lines that reach a lamp from where all else is dark err by more.
    ['bumps', 'studio', 0, 5e-3],
    ['fingers', 'studio', 0, 5e-3],
    ['roughness', 'studio', 0, 5e-3],
  ])(
    'of %s in %s is the reference’s at a roughness of %f rad',
    async (field, name, roughness, most) => {
      const texture = await loadedEnvironment(name)
      const light = lightOf(texture)
      const optics = await fieldOf(field, roughness)
      const found = POINTS.map(({ wo, axes }) =>
        colourOf(
          atOnce(reliefUnderEnvironment(optics, wo, spectrum.wavelengths, light.around(axes))),
        ),
      )
      const expected = await reference(texture, name, FIELD, [field, roughness])
      expect(rms(found, expected)).toBeLessThan(most)
    },
  )

  it.each(['bumps', 'fingers', 'roughness'])('has the powers of the series: %s', async (name) => {
    const { relief } = await fieldOf(name, 0)
    const table = atOnce(linePowers(relief))
    const [across, along] = relief.lines
    for (const p of [0, 0.013, 0.7, 1.9, 3.33, 5.25]) {
      const power = relief.powers(p, 1)
      let kept = 0
      for (let i = 0; i < table.count; i++) {
        const line = [table.fx[i]!, table.fy[i]!].map((f, k) => Math.round(f * relief.patch[k]!))
        expect(Math.abs(table.at(i, p) - power([line[0]!, line[1]!]))).toBeLessThan(1e-4)
        kept += table.at(i, p)
      }
      let all = 0
      for (let j = -across; j <= across; j++)
        for (let l = -along; l <= along; l++)
          // Beyond no direction and visible wavelength reaches.
          if (Math.hypot(...relief.frequency([j, l])) < 2 / 0.38) all += power([j, l])
      expect(Math.abs(all - kept)).toBeLessThan(4e-4)
    }
  })
})

describe('a lacquer', () => {
  const coat = { share: 0.8, ior: 1.55, alpha: 0 }
  const wo: Direction = [0.6, 0, 0.8]

  it('mirrors by Fresnel’s share where it is smooth', () => {
    const light = lightOf(madeEnvironment(64, () => [2, 2, 2]))
    for (const { axes } of POINTS)
      for (const value of coatMirror(coat, wo, light.around(axes)))
        expect(value).toBeCloseTo(2 * 0.8 * fresnel(0.8, 1.55), 5)
    // Schlick's closed form at the normal.
    expect(fresnel(1, 1.55)).toBeCloseTo((0.55 / 2.55) ** 2, 12)
  })

  it('mirrors what lies there', () => {
    // Brighter towards one direction: the place is the mirror's.
    const texture = madeEnvironment(512, (x, y, z) => [1 + x, 1 + y, 1 + z])
    const light = new EnvironmentLight(texture, new Euler(), 1)
    const { axes } = POINTS[1]!
    const mirror = [-0.6, 0, 0.8].reduce(
      (sum, part, k) => sum.addScaledVector(axes[k]!, part),
      new Vector3(),
    )
    const found = coatMirror(coat, wo, light.around(axes))
    mirror.toArray().forEach((part, c) => {
      expect(found[c]).toBeCloseTo(0.8 * fresnel(0.8, 1.55) * (1 + part), 3)
    })
  })

  /** f_r cosθ_i of GGX with the height-correlated Smith term, for unit vectors (n, 3), by its own lines. */
  const GGX = `
import numpy as np
def dielectric(c, n):
    t = np.arcsin(np.sqrt(1 - c**2) / n); i = np.arccos(c)
    s = np.sin(i - t) / np.sin(i + t); p = np.tan(i - t) / np.tan(i + t)
    return (s**2 + p**2) / 2
def lobe(wi, wo, alpha, n):
    h = wi + wo; h /= np.linalg.norm(h, axis=-1, keepdims=True)
    tan2 = 1 / h[..., 2]**2 - 1
    d = 1 / (np.pi * alpha**2 * h[..., 2]**4 * (1 + tan2 / alpha**2)**2)
    masking = lambda w: (np.sqrt(1 + alpha**2 * (1 / w[..., 2]**2 - 1)) - 1) / 2
    g = 1 / (1 + masking(wi) + masking(wo))
    return dielectric(np.sum(wi * h, axis=-1), n) * d * g / (4 * wo[..., 2])
def sphere(rows):
    z = (np.arange(rows) + 0.5) / rows; turn = 2 * np.pi * (np.arange(2 * rows) + 0.5) / (2 * rows)
    z, turn = np.meshgrid(z, turn); r = np.sqrt(1 - z**2)
    return np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=-1), np.pi / rows**2
`

  it.each([0.09, 0.25])('mirrors its whole lobe where it is rough, α = %f', async (alpha) => {
    const [red, green] = (await python(
      `${GGX}
wo, alpha = input
wi, size = sphere(1200)
f = lobe(wi, np.array(wo), alpha, 1.55)
print(json.dumps([0.8 * float(np.sum(f * size * v)) for v in (1, 1 + wi[..., 0])]))`,
      [wo, alpha],
    )) as [number, number]
    const texture = madeEnvironment(512, (x) => [1, 1 + x, 0])
    const light = new EnvironmentLight(texture, new Euler(), 1)
    const axes: Axes = [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)]
    const found = coatMirror({ ...coat, alpha }, wo, light.around(axes))
    expect(found[0] / red).toBeCloseTo(1, 2)
    expect(found[1] / green).toBeCloseTo(1, 2)
  })

  it.each([
    [0.01, 0.03, 0.02],
    [0.04, 0.03, 0.02],
    [0.09, 0.0087, 0.1],
    [0.0025, 0, 0.003],
  ])('shows a lamp: α = %f, a disc of %f rad, %f rad beside', async (alpha, radius, beside) => {
    const θ = Math.acos(0.8) + beside
    const wi: Direction = [
      -Math.sin(θ) * Math.cos(beside),
      Math.sin(θ) * Math.sin(beside),
      Math.cos(θ),
    ]
    // A million places of the disc, by quantiles of its distance and turns of the golden section.
    const expected = (await python(
      `${GGX}
wi, wo, alpha, radius = input
wi = np.array(wi)
k = np.arange(1_000_000) + 0.5
r, turn = radius * np.sqrt(-2 * np.log(k / len(k))), 2 * np.pi * k * 0.6180339887498949
right = np.cross(wi, [0, 0, 1.0]); right /= np.linalg.norm(right)
up = np.cross(right, wi)
places = wi + (r * np.cos(turn))[:, None] * right + (r * np.sin(turn))[:, None] * up
places /= np.linalg.norm(places, axis=1, keepdims=True)
print(json.dumps(0.8 * float(np.mean(lobe(places, np.array(wo), alpha, 1.55)))))`,
      [wi, wo, alpha, radius],
    )) as number
    const found = coatHighlight({ ...coat, alpha }, wi, wo, radius)
    expect(found / expected).toBeCloseTo(1, 2)
  })

  it.each([0, 0.03, 0.1])(
    'mirrors a lamp’s disc as it is where it is smooth: %f rad beside',
    (beside) => {
      // Of a Gaussian disc: Fresnel's share of its radiance, E exp(−θ²/2α²)/(2πα²).
      const θ = Math.acos(0.8) + beside
      const found = coatHighlight(coat, [-Math.sin(θ), 0, Math.cos(θ)], wo, 0.05)
      const disc = Math.exp(-((2 * Math.sin(beside / 2)) ** 2) / 0.005) / (2 * Math.PI * 0.05 ** 2)
      expect(found / (0.8 * fresnel(0.8, 1.55) * disc)).toBeCloseTo(1, 6)
    },
  )
})

describe('irradiance', () => {
  it.each([
    [1, 0, 0],
    [0, 1, 0],
    [0, -1, 0],
    [0.48, 0.6, -0.64],
  ])('is π L under an even sky, and by a closed form under one that is not: %f %f %f', (...n) => {
    // ∫ (1 + a·ω) max(n·ω, 0) dω = π (1 + ⅔ a·n).
    const texture = madeEnvironment(512, (x, y, z) => [1, 1 + 0.5 * x, 1 + 0.4 * y + 0.3 * z])
    const light = new EnvironmentLight(texture, new Euler(), 1.5)
    const [red, green, blue] = light.irradiance(new Vector3(...n))
    expect(red / (1.5 * Math.PI)).toBeCloseTo(1, 3)
    expect(green / (1.5 * Math.PI)).toBeCloseTo(1 + n[0] / 3, 3)
    expect(blue / (1.5 * Math.PI)).toBeCloseTo(1 + (0.8 / 3) * n[1] + 0.2 * n[2], 3)
  })

  it('of a lone lamp is that of a plane that faces it, times its cosine', () => {
    const lamp = new Vector3(0.36, 0.48, 0.8)
    // Radiance exp((cos − 1)/s) about it: ∫ L cos dω = 2π s (1 − s).
    const s = 0.0025
    const light = new EnvironmentLight(
      madeEnvironment(512, (x, y, z) => [
        100 * Math.exp((x * lamp.x + y * lamp.y + z * lamp.z - 1) / s),
        0,
        0,
      ]),
      new Euler(),
      1,
    )
    const facing = light.irradiance(lamp)[0]
    expect(facing / (100 * 2 * Math.PI * s * (1 - s))).toBeCloseTo(1, 3)
    for (const normal of [new Vector3(0, 0, 1), new Vector3(0, 1, 0), new Vector3(1, 0, 0)])
      expect((light.irradiance(normal)[0] * (1 - s)) / facing).toBeCloseTo(normal.dot(lamp), 2)
    expect(light.irradiance(new Vector3(0, 0, -1))[0]).toBeLessThan(1e-6)
  })
})

describe('a foil’s bumps', () => {
  const STEEPEST = 0.1
  /** Offset and scale of a slope's texel, of which 128 is none (precompute/foils/bumps.py). */
  const DECODE: [number, number] = [(-STEEPEST * 128) / 127, (STEEPEST * 255) / 127]
  const slope = (texel: number): number => (STEEPEST * (texel - 128)) / 127

  /** The polygons' foil with such slopes; the first row on top. */
  async function bumpy(texels: [u: number, v: number][], size: number): Promise<Foil> {
    const map = await loadMap('maps/baked/foil-polygons')
    const data = Uint8Array.from(texels.flatMap(([u, v]) => [u, v, 255, 255]))
    const spec = {
      ...map.arrays['grating']!.spec,
      shape: [size, size, 4],
      decode: [DECODE, DECODE, [0, 1], [0, 1]] as [number, number][],
    }
    return new Foil({ ...map, arrays: { ...map.arrays, normal: { spec, data } } })
  }

  const [, , { axes: frame }] = POINTS as [Point, Point, Point]
  const projected = (direction: Vector3, normal: Vector3): Vector3 =>
    direction.clone().addScaledVector(normal, -direction.dot(normal)).normalize()
  /** The plane that leans by (p, q): its tangent as on any mesh, where u grows, projected into the plane. */
  const leaning = (p: number, q: number): Axes => {
    const n = frame[2].clone().addScaledVector(frame[0], p).addScaledVector(frame[1], q).normalize()
    const t = projected(frame[0], n)
    return [t, n.clone().cross(t), n]
  }

  it('bend the frame, blended between texels and from tile to tile', async () => {
    const texels: [number, number][] = Array.from({ length: 16 }, (_, i) => [
      20 + 13 * i,
      235 - ((29 * i) % 200),
    ])
    const foil = await bumpy(texels, 4)
    foil.repeat = new Vector2(2, 3)
    const at = (column: number, row: number): [number, number] => texels[4 * row + column]!
    const between = (...of: [number, number][]): [number, number] =>
      [0, 1].map((c) => of.reduce((sum, texel) => sum + slope(texel[c]!), 0) / of.length) as [
        number,
        number,
      ]
    for (const [column, row, expected] of [
      [2, 1, between(at(2, 1))],
      [1.5, 2, between(at(1, 2), at(2, 2))],
      [3.5, 3.5, between(at(3, 3), at(0, 3), at(3, 0), at(0, 0))],
    ] as const) {
      // In the second tile along u, the third along v.
      const uv = new Vector2((1 + (column + 0.5) / 4) / 2, (2 + 1 - (row + 0.5) / 4) / 3)
      bentFrame(frame, foil, uv).forEach((axis, k) => {
        expect(axis.distanceTo(leaning(...expected)[k]!)).toBeLessThan(1e-6)
      })
    }
  })

  it('show what a plane would that leans as they do, on its matt base too', async () => {
    const [flat, lean] = [await bumpy([[128, 128]], 1), await bumpy([[172, 96]], 1)]
    const place = { uv: new Vector2(0.37, 0.61), mesh: new Mesh() } as PickedPoint
    const material = {
      ...{ mapsPath: 'maps/baked/', observer: '1931-2', illuminant: 'D65', metal: 'aluminium' },
      ...{
        energy: 'conserving',
        coherence: 16.25,
        roughness: 0.01,
        color: new Color(0.5, 0.4, 0.3),
      },
      coat: 0,
    }
    const [t, , n] = frame
    const situation = {
      eye: n.clone().multiplyScalar(3).addScaledVector(t, 0.5),
      flash: { position: n.clone().multiplyScalar(2), intensity: 2, angularRadius: 0.02 },
    }
    const light = lightOf(await loadedEnvironment('studio'))
    const shown = async (surface: Foil, axes: Axes): Promise<Colour[]> => {
      const subject = { surface, material } as unknown as Subject
      const [tangent, bitangent, normal] = axes
      const optics = pointOptics(
        subject,
        await loadTables(subject),
        place,
        { position: new Vector3(), tangent, bitangent, normal },
        situation,
      )
      const partial = { ...optics, strength: 0.6 }
      return [flashRadiance(partial).colour, atOnce(environmentRadiance(partial, light)).colour]
    }
    const found = await shown(lean, frame)
    expect(apart(found, await shown(flat, leaning(slope(172), slope(96))))).toBeLessThan(1e-6)
    expect(apart(found, await shown(flat, frame))).toBeGreaterThan(0.01)
  })
})
