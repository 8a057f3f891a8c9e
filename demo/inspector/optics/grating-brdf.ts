import type { Energy } from '../../../web'
import { windowVariance } from '../../../web/spectrum/spectrum-optics'
import { normalCdf } from '../../numbers/normal-cdf'
import type { Efficiency } from './efficiency'
import { kirchhoffFactor } from './kirchhoff'
import { gaussian, lobeCovariance, type Widening } from './lobe'
import { orderDirection, squaredCosine, sumOf, type Direction } from './orders'

/** One grating, and how its light is counted. */
export interface GratingOptics extends Widening {
  /** a, µm. */
  period: number
  /** h0, µm. */
  height: number
  efficiency: Efficiency
  /** The largest |m| that is shown. */
  maxOrder: number
  /** R(λ) of the metal; λ in µm. */
  reflectance: (wavelength: number) => number
  energy: Energy
}

/** Below, what scalar theory says of the rest is noise; the shaders stop here too. */
const LEAST_EFFICIENCY = 1e-4
/** Orders whose density over (u, v) is lower have no part: the largest are 1e2 and more. */
const LEAST_DENSITY = 1e-9

/**
 * f_r(ω_i, ω_o, λ) in 1/sr as a sum over orders' powers (docs/theory/gratings.md): exact for σ ≥ a, where orders do not
 * interfere.
 *
 * @param wi - ω_i; there is nothing below the horizon, as for ω_o
 * @param wavelength - λ, µm
 * @param angularRadius - α of the light, rad
 */
export function gratingBrdf(
  grating: GratingOptics,
  wi: Direction,
  wo: Direction,
  wavelength: number,
  angularRadius: number,
): number {
  if (!(wi[2] > 0 && wo[2] > 0)) return 0
  const [u, v, w] = sumOf(wi, wo)
  let sum = 0
  for (let order = -grating.maxOrder; order <= grating.maxOrder; order++) {
    const offset = (order * wavelength) / grating.period
    const own =
      grating.energy === 'conserving'
        ? wo[2] + Math.sqrt(Math.max(squaredCosine(wo, offset), 0))
        : w
    const covariance = lobeCovariance(grating, wi, own, angularRadius, wavelength)
    const density = gaussian(covariance, u - offset, v)
    if (density > LEAST_DENSITY)
      sum += density * grating.efficiency(order, phaseOf(grating, own, wavelength))
  }
  if (sum === 0) return 0
  return (
    sum * grating.reflectance(wavelength) * energyFactor(grating, wi, wo, wavelength, lobesAbove)
  )
}

/**
 * e_m of the orders of a plane wave between ω_o and ω_m: the share of the light that each takes; 0 where one does not
 * propagate.
 *
 * @param wavelength - λ, µm
 * @param shares - where they go, from −maxOrder on
 */
export function orderShares(
  grating: GratingOptics,
  wo: Direction,
  wavelength: number,
  shares = new Float64Array(2 * grating.maxOrder + 1),
): Float64Array {
  const reflectance = grating.reflectance(wavelength)
  const factor = (wi: Direction): number =>
    reflectance * energyFactor(grating, wi, wo, wavelength, ordersAbove)
  // N(ω_o) alone: one for all orders.
  const conserving = grating.energy === 'conserving' ? factor(wo) : null
  for (let order = -grating.maxOrder; order <= grating.maxOrder; order++) {
    const at = order + grating.maxOrder
    const wi = orderDirection(wo, order, wavelength, grating.period)
    shares[at] =
      wi === null
        ? 0
        : grating.efficiency(order, phaseOf(grating, wi[2] + wo[2], wavelength)) *
          (conserving ?? factor(wi))
  }
  return shares
}

/** φ = 2π w h0/λ, rad. */
function phaseOf({ height }: GratingOptics, w: number, wavelength: number): number {
  return (2 * Math.PI * w * height) / wavelength
}

type Total = (grating: GratingOptics, direction: Direction, wavelength: number) => number

function energyFactor(
  grating: GratingOptics,
  wi: Direction,
  wo: Direction,
  wavelength: number,
  total: Total,
): number {
  if (grating.energy === 'kirchhoff') return kirchhoffFactor(wi, wo)
  let n = total(grating, wo, wavelength)
  if (grating.energy === 'reciprocal') n = Math.max(n, total(grating, wi, wavelength))
  return 1 / Math.max(n, LEAST_EFFICIENCY)
}

/** N(ω, λ) of plane waves: Σ η_j over the orders that propagate. */
const ordersAbove: Total = (grating, direction, wavelength) =>
  sumOverOrders(grating, direction, wavelength, (squared) => (squared > 0 ? 1 : 0))

/** N(ω, λ) of lobes: Σ η_j H_j, H_j = Φ((1 − r)/c) the part of order j's lobe above the horizon. */
const lobesAbove: Total = (grating, direction, wavelength) =>
  sumOverOrders(grating, direction, wavelength, (squared, w) => {
    const variance =
      wavelength ** 2 * windowVariance(grating.coherence) + (w * grating.roughness) ** 2
    // 1 − r² keeps the digits of 1 − r.
    const r = Math.sqrt(Math.max(1 - squared, 0))
    return normalCdf(squared / (1 + r) / Math.sqrt(variance))
  })

function sumOverOrders(
  grating: GratingOptics,
  direction: Direction,
  wavelength: number,
  above: (squaredCosine: number, w: number) => number,
): number {
  let sum = 0
  for (let order = -grating.maxOrder; order <= grating.maxOrder; order++) {
    const squared = squaredCosine(direction, (order * wavelength) / grating.period)
    const w = direction[2] + Math.sqrt(Math.max(squared, 0))
    const share = above(squared, w)
    if (share > 0) sum += share * grating.efficiency(order, phaseOf(grating, w, wavelength))
  }
  return sum
}
