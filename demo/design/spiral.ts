import { normalCdf } from '../numbers/normal-cdf'
import { GratingDistribution } from './distribution'

const ORIENTATIONS = 90
const FREQUENCIES = 96
/** Deviations of the period beyond the shortest and the longest. */
const REACH = 4
/** Places within a cell of orientation at which its frequencies are taken. */
const ABSCISSAE = 8

/** Lengths in µm; spread: standard deviation of the period over the period. */
export interface SpiralDistribution {
  kind: 'spiral'
  shortest: number
  longest: number
  spread: number
}

/**
 * Orientations evenly, and about a(θ) = shortest + (longest − shortest)·θ/π a Gaussian of periods each: the cells and shares
 * of `precompute.foils.spiral`.
 */
export function spiral({ shortest, longest, spread }: SpiralDistribution): GratingDistribution {
  const frequencies = linspace(
    1 / (longest * (1 + REACH * spread)),
    1 / (shortest * (1 - REACH * spread)),
    FREQUENCIES,
  )
  const weights = new Float64Array(ORIENTATIONS * FREQUENCIES)
  for (let i = 0; i < ORIENTATIONS * ABSCISSAE; i++) {
    const share = (i + 0.5) / (ORIENTATIONS * ABSCISSAE)
    const period = shortest + (longest - shortest) * share
    const longer = frequencies.map((f) => normalCdf((1 / f - period) / (spread * period)))
    const row = Math.floor(i / ABSCISSAE) * FREQUENCIES
    for (let k = 0; k < FREQUENCIES; k++)
      weights[row + k]! += (longer[k]! - longer[k + 1]!) / ABSCISSAE
  }
  return new GratingDistribution(linspace(0, Math.PI, ORIENTATIONS), frequencies, weights)
}

/** Edges of so many equal cells. */
function linspace(first: number, last: number, cells: number): number[] {
  const step = (last - first) / cells
  return Array.from({ length: cells + 1 }, (_, i) => (i === cells ? last : first + i * step))
}
