import type { IUniform } from 'three'
import { floatLiteral } from '../glsl/float-literal.ts'
import { arrayOf, constantOf, type LoadedMap } from '../maps/load.ts'
import type { OpticsSettings } from '../surfaces/surface.ts'
import { xyzToRgb } from './spectrum-maps.ts'

/** Width of the visible range in wavelength, µm. */
const VISIBLE = 0.4

/**
 * Share of a node's arc over which the environment is filtered. A mip level blurs across the arc as much as along it, so
 * less than the whole arc is best: of 0, 0.35, 0.5, 0.7 and 1 none did better at 8, 12, 16 and 21 nodes taken together,
 * under the studio, venice, night and warehouse environments of @pmndrs/assets, on gratings of 0.62 and 1.66 µm.
 */
export const ARC_FILTER = 0.35

/** How many wavelengths a loop in steps of that many µm visits, both ends included. */
export function wavelengthsOfLoop(step: number): number {
  return Math.round(VISIBLE / step) + 1
}

/** Variance of the coherence window's lobe in spatial frequency, 1/µm². coherence: σ, µm. */
export function windowVariance(coherence: number): number {
  return 1 / (8 * Math.PI ** 2 * coherence ** 2)
}

/** Defines and uniforms of shaders/spectrum.glsl and shaders/lobe.glsl but for their textures, and the way to colours. */
export function spectrumOptics(
  lobes: LoadedMap,
  { coherence, roughness }: OpticsSettings,
): { defines: Record<string, string | number>; uniforms: Record<string, IUniform> } {
  const [, widths, positions] = arrayOf(lobes, 'lobe').spec.axes
  const constant = (name: string): string => floatLiteral(constantOf(lobes, name)[0]!)
  return {
    defines: {
      EXPONENT_CUT: constant('exponent_cut'),
      LOBE_MARGIN: constant('margin'),
      LOBE_POSITIONS: floatLiteral(positions!.size),
      LOBE_WIDTHS: floatLiteral(widths!.size),
      LOBE_WIDTH_MIN: floatLiteral(widths!.first),
      LOBE_WIDTH_MAX: floatLiteral(widths!.last),
      WAVENUMBER_MIN: constant('wavenumber_min'),
      WAVENUMBER_MAX: constant('wavenumber_max'),
      ...(roughness > 0 && { ROUGH: '' }),
    },
    uniforms: {
      uWindowVariance: { value: windowVariance(coherence) },
      uRoughness: { value: roughness },
      uXyzToRgb: { value: xyzToRgb(lobes) },
    },
  }
}
