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

/** An order's part in f_r, 1/sr. */
export interface OrderPart {
  order: number
  value: number
}

/**
 * f_r(ω_i, ω_o, λ) in 1/sr as a sum over orders' powers (docs/theory/gratings.md): exact for σ ≥ a, where orders do not
 * interfere. Orders whose part is below 1e-9 of the largest possible are left out.
 *
 * @param wi - ω_i, above the horizon, as ω_o
 * @param wavelength - λ, µm
 * @param angularRadius - α of the light, rad
 */
export function orderParts(
  grating: GratingOptics,
  wi: Direction,
  wo: Direction,
  wavelength: number,
  angularRadius: number,
): OrderPart[] {
  if (!(wi[2] > 0 && wo[2] > 0)) return []
  const [u, v, w] = sumOf(wi, wo)
  const parts: OrderPart[] = []
  for (let order = -grating.maxOrder; order <= grating.maxOrder; order++) {
    const offset = (order * wavelength) / grating.period
    const own =
      grating.energy === 'conserving'
        ? wo[2] + Math.sqrt(Math.max(squaredCosine(wo, offset), 0))
        : w
    const covariance = lobeCovariance(grating, wi, own, angularRadius, wavelength)
    const density = gaussian(covariance, u - offset, v)
    if (density > 1e-9)
      parts.push({
        order,
        value: density * grating.efficiency(order, phaseOf(grating, own, wavelength)),
      })
  }
  if (parts.length === 0) return []
  const factor =
    grating.reflectance(wavelength) * energyFactor(grating, wi, wo, wavelength, lobesAbove)
  return parts.map(({ order, value }) => ({ order, value: factor * value }))
}

/** e_m of an order of a plane wave between ω_o and ω_m: the share of the light that it takes; 0 where it does not propagate. */
export function orderShare(
  grating: GratingOptics,
  wo: Direction,
  order: number,
  wavelength: number,
): number {
  const wi = orderDirection(wo, order, wavelength, grating.period)
  if (wi === null) return 0
  const η = grating.efficiency(order, phaseOf(grating, wi[2] + wo[2], wavelength))
  return (
    grating.reflectance(wavelength) * energyFactor(grating, wi, wo, wavelength, ordersAbove) * η
  )
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
