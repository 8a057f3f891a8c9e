import type { EnvironmentLight } from './optics/environment-light'
import { orderParts, orderShare } from './optics/grating-brdf'
import { kirchhoffFactor } from './optics/kirchhoff'
import type { Colour } from './optics/light-spectrum'
import { orderDirection, type Direction } from './optics/orders'
import { reliefBrdf, strongestLines } from './optics/relief'
import type { PointOptics } from './point-optics'

/** What reaches the eye over wavelength, as factors on the illuminant's spectrum, and its colour. */
export interface Radiance {
  /** One for each `stride`-th nanometre. */
  factors: Float64Array
  stride: number
  /** Linear sRGB, the matt base's share included. */
  colour: Colour
}

/** Radiance from the flash: f_r(λ) cosθ_i E(λ), at each nanometre. */
export function flashRadiance(optics: PointOptics): Radiance {
  const { tables, wi, wo, irradiance, angularRadius, through, strength, base } = optics
  const { spectrum } = tables
  const scale = Math.max(wi[2], 0) * irradiance * through.flash
  const factors = Float64Array.from(spectrum.wavelengths, (wavelength) =>
    scale === 0 ? 0 : scale * strength * brdf(optics, wavelength),
  )
  const colour = spectrum.colour(factors)
  const isSeen = wo[2] > 0
  return {
    factors,
    stride: 1,
    colour: colour.map(
      (value, c) => value + (isSeen ? (1 - strength) * through.flash * base[c]! : 0),
    ) as Colour,
  }

  function brdf({ grating, relief }: PointOptics, wavelength: number): number {
    if (relief !== null) return reliefBrdf(relief, wi, wo, wavelength, angularRadius)
    if (!grating?.optics) return 0
    return orderParts(grating.optics, wi, wo, wavelength, angularRadius).reduce(
      (sum, { value }) => sum + value,
      0,
    )
  }
}

/** Wavelengths at which an environment is read: every so many nanometres. */
const ENVIRONMENT_STRIDE = 5
/** Tilts of a rough surface, in standard deviations along either axis, and their shares: Gauss and Hermite's three nodes. */
const TILTS = [
  [-Math.sqrt(3), 1 / 6],
  [0, 2 / 3],
  [Math.sqrt(3), 1 / 6],
] as const
const NO_TILT = [[0, 1]] as const
/** What takes less of the light is read in its middle alone. */
const BLURRED_SHARE = 2e-3

/** A place that light comes from at a wavelength, and the share of its radiance that reaches the eye. */
interface Way {
  wi: Direction
  share: number
}

/** Radiance from the environment: an arc of it for each order, or line (docs/theory/environments.md). */
export function environmentRadiance(optics: PointOptics, light: EnvironmentLight): Radiance {
  const { tables, axes, wo, through, strength } = optics
  const { spectrum } = tables
  const count = Math.floor((spectrum.wavelengths.length - 1) / ENVIRONMENT_STRIDE) + 1
  const factors = new Float64Array(count)
  const ways = wo[2] > 0 ? waysOf(optics) : () => []
  const roughness = optics.grating?.optics?.roughness ?? optics.relief?.roughness ?? 0
  for (let i = 0; i < count; i++) {
    const cell = i * ENVIRONMENT_STRIDE
    const seen = [0, 0, 0]
    for (const { wi, share } of ways(spectrum.wavelengths[cell]!)) {
      if (share < 1e-5) continue
      const move = (wi[2] + wo[2]) * roughness
      const tilts = roughness > 0 && share > BLURRED_SHARE ? TILTS : NO_TILT
      for (const [x, shareX] of tilts)
        for (const [y, shareY] of tilts) {
          const direction = moved(wi, move * x, move * y)
          const world = inWorld(axes, direction)
          light
            .radiance(...world)
            .forEach((value, c) => (seen[c]! += share * shareX * shareY * value))
        }
    }
    factors[i] =
      through.environment *
      strength *
      seen.reduce((sum, value, tint) => sum + value * spectrum.basis(cell, tint), 0)
  }
  return {
    factors,
    stride: ENVIRONMENT_STRIDE,
    colour: spectrum.colour(factors, ENVIRONMENT_STRIDE),
  }
}

function waysOf({ grating, relief, wo }: PointOptics): (wavelength: number) => Way[] {
  if (relief !== null) {
    const lines = strongestLines(relief.relief, 2 * wo[2], 0.55)
    return (wavelength) =>
      lines.flatMap(({ line, power }) => {
        const wi = lineDirection(wo, relief.relief.frequency(line), wavelength)
        if (wi === null) return []
        // The depth differs a little from line to line; their own powers would take a series each.
        return [
          { wi, share: relief.reflectance(wavelength, wi, wo) * kirchhoffFactor(wi, wo) * power },
        ]
      })
  }
  const optics = grating?.optics
  if (!optics) return () => []
  return (wavelength) =>
    Array.from({ length: 2 * optics.maxOrder + 1 }, (_, i) => i - optics.maxOrder).flatMap(
      (order) => {
        const wi = orderDirection(wo, order, wavelength, optics.period)
        return wi === null ? [] : [{ wi, share: orderShare(optics, wo, order, wavelength) }]
      },
    )
}

/** (ω_i)_xy = λ f − (ω_o)_xy of a line; null below the horizon. frequency: 1/µm. */
export function lineDirection(
  wo: Direction,
  [fx, fy]: readonly [number, number],
  wavelength: number,
): Direction | null {
  const [x, y] = [wavelength * fx - wo[0], wavelength * fy - wo[1]]
  const squared = 1 - x * x - y * y
  return squared > 0 ? [x, y, Math.sqrt(squared)] : null
}

/** A direction moved within the surface's plane, held at the horizon. */
function moved([t, b]: Direction, dt: number, db: number): Direction {
  const length = Math.max(Math.hypot(t + dt, b + db), 1)
  const [x, y] = [(t + dt) / length, (b + db) / length]
  return [x, y, Math.sqrt(Math.max(1 - x * x - y * y, 0))]
}

/** A direction of the point's axes in the world's. */
export function inWorld(
  axes: PointOptics['axes'],
  [t, b, n]: Direction,
): [x: number, y: number, z: number] {
  const [a, c, d] = axes
  return [t * a.x + b * c.x + n * d.x, t * a.y + b * c.y + n * d.y, t * a.z + b * c.z + n * d.z]
}
