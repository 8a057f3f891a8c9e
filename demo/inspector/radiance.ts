import type { Steps } from '../../web/steps'
import { coatHighlight, coatMirror } from './optics/coat'
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
  /** Linear sRGB of all that is seen: also of the matt base, and of what the lacquer reflects. */
  colour: Colour
}

/** Radiance from the flash: f_r(λ) cosθ_i E(λ), at each nanometre. */
export function flashRadiance(optics: PointOptics): Radiance {
  const { tables, wi, irradiance, angularRadius, through, strength, lacquer, isSeen } = optics
  const { spectrum } = tables
  const lit = Math.max(wi[2], 0) * irradiance * through.flash
  const factors = Float64Array.from(spectrum.wavelengths, (wavelength) =>
    lit === 0 ? 0 : lit * strength * brdf(optics, wavelength),
  )
  const highlight =
    lacquer === null
      ? 0
      : irradiance * coatHighlight(lacquer.coat, lacquer.wi, lacquer.wo, angularRadius)
  const base = isSeen ? (lit * (1 - strength)) / Math.PI : 0
  const diffracted = spectrum.colour(factors)
  return {
    factors,
    colour: diffracted.map((value, c) => value + base * optics.albedo[c]! + highlight) as Colour,
  }
}

function brdf({ grating, relief, wi, wo, angularRadius }: PointOptics, wavelength: number): number {
  if (relief !== null) return reliefBrdf(relief, wi, wo, wavelength, angularRadius)
  if (!grating?.optics) return 0
  return gratingBrdf(grating.optics, wi, wo, wavelength, angularRadius)
}

/** Radiance from the environment, at each nanometre. */
export function* environmentRadiance(
  optics: PointOptics,
  light: EnvironmentLight,
): Steps<Radiance> {
  const { tables, axes, through, strength, albedo, lacquer, isSeen } = optics
  const { spectrum } = tables
  const seen = yield* seenOf(optics, light)
  const scale = through.environment * strength
  const factors = Float64Array.from(spectrum.wavelengths, (_, cell) => {
    if (seen === null) return 0
    let sum = 0
    for (let tint = 0; tint < 3; tint++) sum += seen[3 * cell + tint]! * spectrum.basis(cell, tint)
    return scale * sum
  })
  const base = isSeen ? (through.environment * (1 - strength)) / Math.PI : 0
  const irradiance = base === 0 ? [0, 0, 0] : light.irradiance(axes[2])
  const mirrored =
    lacquer === null ? [0, 0, 0] : coatMirror(lacquer.coat, lacquer.wo, light.around(lacquer.axes))
  const diffracted = spectrum.colour(factors)
  return {
    factors,
    colour: diffracted.map(
      (value, c) => value + base * irradiance[c]! * albedo[c]! + mirrored[c]!,
    ) as Colour,
  }
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
