import type { LocalEnvironment } from './environment-light'
import { orderShares, type GratingOptics } from './grating-brdf'
import type { Direction } from './orders'
import { TiltedEnvironment } from './tilted-environment'

/** Orders that take less of the light are left out. */
const LEAST_SHARE = 1e-6

/**
 * Light of an environment that a grating sends to the viewer: an arc of it for each order (docs/theory/environments.md).
 *
 * @param wo - ω_o, above the horizon
 * @param wavelengths - µm
 * @param environment - in the grating's axes
 * @returns for each wavelength the environment's linear sRGB times what the orders take, three numbers
 */
export function gratingUnderEnvironment(
  grating: GratingOptics,
  wo: Direction,
  wavelengths: readonly number[],
  environment: LocalEnvironment,
): Float64Array {
  const { maxOrder, period, roughness } = grating
  const tilted = new TiltedEnvironment(environment, wo, roughness, true)
  const shares = new Float64Array(2 * maxOrder + 1)
  const seen = new Float64Array(3 * wavelengths.length)
  wavelengths.forEach((wavelength, i) => {
    orderShares(grating, wo, wavelength, shares)
    for (let order = -maxOrder; order <= maxOrder; order++) {
      const share = shares[order + maxOrder]!
      if (share < LEAST_SHARE) continue
      tilted.add((order * wavelength) / period - wo[0], -wo[1], share, seen, 3 * i)
    }
  })
  return seen
}
