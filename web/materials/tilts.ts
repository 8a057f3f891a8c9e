import { Vector3 } from 'three'

/**
 * Share of a rough surface's deviation that stays with each facet, the blur of a mip level.
 */
export const REST_OF_ROUGHNESS = 0.4

/** Facets along each axis. */
const NODES = 5
const SPACING = 1

/**
 * Facets that stand for a rough surface: a grid of tilts whose variance, with that of the facets' own rest, is the
 * surface's.
 *
 * @param roughness - standard deviation of the tilt along an axis, rad
 * @returns tilt along x and y, rad, and weight; weights add up to 1
 */
export function tilts(roughness: number): Vector3[] {
  const middle = (NODES - 1) / 2
  const positions = Array.from({ length: NODES }, (_, i) => SPACING * (i - middle))
  const bell = positions.map((x) => Math.exp((-x * x) / 2))
  const total = bell.reduce((sum, value) => sum + value, 0)
  const weights = bell.map((value) => value / total)
  // Cut off and sampled, the bell is a little narrower or wider than it was.
  const variance = positions.reduce((sum, x, i) => sum + weights[i]! * x * x, 0)
  const scale = roughness * Math.sqrt((1 - REST_OF_ROUGHNESS ** 2) / variance)
  return positions.flatMap((x, i) =>
    positions.map((y, j) => new Vector3(scale * x, scale * y, weights[i]! * weights[j]!)),
  )
}
