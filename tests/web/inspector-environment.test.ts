import { Euler, Matrix4, Vector3, type DataTexture } from 'three'
import { afterAll, beforeAll, describe, expect, it, vi } from 'vitest'
import { efficiencyOf } from '../../demo/inspector/optics/efficiency'
import { EnvironmentLight } from '../../demo/inspector/optics/environment-light'
import type { GratingOptics } from '../../demo/inspector/optics/grating-brdf'
import { gratingUnderEnvironment } from '../../demo/inspector/optics/grating-environment'
import { LightSpectrum, type Colour } from '../../demo/inspector/optics/light-spectrum'
import type { Direction } from '../../demo/inspector/optics/orders'
import { loadMap, type LoadedMap } from '../../web/maps/load'
import { maxOrder } from '../../web/spectrum/max-order'
import { metalReflectance } from '../../web/spectrum/metal-reflectance'
import { serveBakedMaps } from './baked-maps'
import { loadedEnvironment, madeEnvironment, texelFile } from './environments'
import { python } from './python'

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
