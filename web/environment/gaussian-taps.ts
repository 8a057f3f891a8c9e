import { Vector2 } from 'three'

/** A Gaussian is cut off where it has 1 % of its peak, 3 deviations from it. */
const REACH = 3

/**
 * Taps that blur by a Gaussian of deviation 1 along an axis.
 *
 * @param count - odd, 5 or more
 * @param isFiltered - whether what each tap reads is blurred by as much as it stands for
 * @returns the taps' places and weights, which add up to 1, and the full width of what a tap stands for
 */
export function gaussianTaps(
  count: number,
  isFiltered: boolean,
): { taps: Vector2[]; width: number } {
  const width = (2 * REACH) / (count - 1)
  const places = Array.from({ length: count }, (_, i) => i * width - REACH)
  const bell = places.map((x) => Math.exp((-x * x) / 2))
  const total = bell.reduce((sum, value) => sum + value, 0)
  const weights = bell.map((value) => value / total)
  // A lookup of a full width has half of it for its deviation (shaders/grating.glsl); taps make up the rest to 1.
  const own = isFiltered ? (width / 2) ** 2 : 0
  const variance = places.reduce((sum, x, i) => sum + weights[i]! * x * x, 0)
  const scale = Math.sqrt((1 - own) / variance)
  return { taps: places.map((x, i) => new Vector2(scale * x, weights[i])), width }
}
