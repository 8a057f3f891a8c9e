import type { Steps } from '../../web/steps'
import type { EnvironmentLight } from './optics/environment-light'
import { gratingBrdf } from './optics/grating-brdf'
import { gratingUnderEnvironment } from './optics/grating-environment'
import type { Colour } from './optics/light-spectrum'
import { reliefBrdf } from './optics/relief'
import { reliefUnderEnvironment } from './optics/relief-environment'
import type { PointOptics } from './point-optics'

/** What reaches the eye over wavelength, as factors on the illuminant's spectrum, and its colour. */
export interface Radiance {
  /** Of what is diffracted, one for each nanometre. */
  factors: Float64Array
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
    colour: colour.map(
      (value, c) => value + (isSeen ? (1 - strength) * through.flash * base[c]! : 0),
    ) as Colour,
  }

  function brdf({ grating, relief }: PointOptics, wavelength: number): number {
    if (relief !== null) return reliefBrdf(relief, wi, wo, wavelength, angularRadius)
    if (!grating?.optics) return 0
    return gratingBrdf(grating.optics, wi, wo, wavelength, angularRadius)
  }
}

/** Radiance from the environment, at each nanometre. */
export function* environmentRadiance(
  optics: PointOptics,
  light: EnvironmentLight,
): Steps<Radiance> {
  const { tables, through, strength } = optics
  const { spectrum } = tables
  const seen = yield* seenOf(optics, light)
  const scale = through.environment * strength
  const factors = Float64Array.from(spectrum.wavelengths, (_, cell) => {
    if (seen === null) return 0
    let sum = 0
    for (let tint = 0; tint < 3; tint++) sum += seen[3 * cell + tint]! * spectrum.basis(cell, tint)
    return scale * sum
  })
  return { factors, colour: spectrum.colour(factors) }
}

/** The environment's linear sRGB times what diffraction takes of it, three numbers a nanometre; null where that is nothing. */
function* seenOf(
  { tables, axes, wo, grating, relief }: PointOptics,
  light: EnvironmentLight,
): Steps<Float64Array | null> {
  if (wo[2] <= 0) return null
  const { wavelengths } = tables.spectrum
  const around = light.around(axes)
  if (relief !== null) return yield* reliefUnderEnvironment(relief, wo, wavelengths, around)
  if (!grating?.optics) return null
  return gratingUnderEnvironment(grating.optics, wo, wavelengths, around)
}
