import { windowVariance } from '../../../web/spectrum/spectrum-optics'
import type { Direction } from './orders'

/** What gives lobes their width. */
export interface Widening {
  /** Standard deviation σ of the coherence window, µm. */
  coherence: number
  /** Standard deviation of the surface's tilt, rad. */
  roughness: number
}

/** A covariance in the plane of (u, v). */
export interface Covariance {
  uu: number
  vv: number
  uv: number
}

/**
 * C = λ²/(8π²σ²)·1 + (wδ)²·1 + α²(1 − d dᵀ), d = (ω_i)_xy (docs/theory/gratings.md).
 *
 * @param w - cosθ_i + cosθ_o
 * @param angularRadius - α, rad
 * @param wavelength - λ, µm
 */
export function lobeCovariance(
  { coherence, roughness }: Widening,
  wi: Direction,
  w: number,
  angularRadius: number,
  wavelength: number,
): Covariance {
  const round = wavelength ** 2 * windowVariance(coherence) + (w * roughness) ** 2
  const source = angularRadius ** 2
  return {
    uu: round + source * (1 - wi[0] ** 2),
    vv: round + source * (1 - wi[1] ** 2),
    uv: -source * wi[0] * wi[1],
  }
}

/** A normalised two-dimensional Gaussian at (du, dv) from its middle. */
export function gaussian({ uu, vv, uv }: Covariance, du: number, dv: number): number {
  const determinant = uu * vv - uv * uv
  const exponent = (vv * du * du - 2 * uv * du * dv + uu * dv * dv) / (2 * determinant)
  return Math.exp(-exponent) / (2 * Math.PI * Math.sqrt(determinant))
}
