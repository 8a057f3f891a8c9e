import { Matrix3 } from 'three'
import { constantOf, type LoadedMap } from '../maps/load.ts'
import type { OpticsSettings } from '../surfaces/surface.ts'

/** The addresses of the light's lobes and of the metals, which every surface's optics read. */
export function spectrumUrls(
  { illuminant, observer }: OpticsSettings,
  mapsPath: string,
): { lobes: string; metals: string } {
  return {
    lobes: illuminant.includes('/') ? illuminant : `${mapsPath}lobes-${observer}-${illuminant}`,
    metals: `${mapsPath}metals`,
  }
}

/** From XYZ to linear sRGB, white for a perfect mirror. lobes: a map of kind 'lobes'. */
export function xyzToRgb(lobes: LoadedMap): Matrix3 {
  return new Matrix3().fromArray(constantOf(lobes, 'xyz_to_rgb')).transpose()
}
