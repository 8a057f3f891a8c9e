import { normalCdf } from '../numbers/normal-cdf'
import type { NumpyRandom } from './numpy-random'
import type { Work } from './work'

const ORIENTATIONS = 90
const FREQUENCIES = 96
/** Deviations of the period beyond the shortest and the longest. */
const REACH = 4
/** Places within a cell of orientation at which its frequencies are taken. */
const ABSCISSAE = 8
const AT_ONCE = 1024

/** Orientations, rad, and 1/period, 1/µm, of gratings one by one. */
export interface DrawnGratings {
  orientation: Float64Array
  frequency: Float64Array
}

/**
 * Orientations evenly, and about a(θ) = shortest + (longest − shortest)·θ/π a Gaussian of periods each: the cells and shares
 * of `precompute.foils.spiral`, drawn from as its `GratingDistribution` is.
 */
export class Spiral {
  readonly #orientations = linspace(0, Math.PI, ORIENTATIONS)
  readonly #frequencies: readonly number[]
  /** The sum of shares up to each cell, orientation by orientation. */
  readonly #cumulative: Float64Array

  /** Lengths in µm; spread: standard deviation of the period over the period. */
  constructor(spiral: { shortest: number; longest: number; spread: number }) {
    const { shortest, longest, spread } = spiral
    this.#frequencies = linspace(
      1 / (longest * (1 + REACH * spread)),
      1 / (shortest * (1 - REACH * spread)),
      FREQUENCIES,
    )
    const weights = new Float64Array(ORIENTATIONS * FREQUENCIES)
    for (let i = 0; i < ORIENTATIONS * ABSCISSAE; i++) {
      const share = (i + 0.5) / (ORIENTATIONS * ABSCISSAE)
      const period = shortest + (longest - shortest) * share
      const longer = this.#frequencies.map((f) => normalCdf((1 / f - period) / (spread * period)))
      const row = Math.floor(i / ABSCISSAE) * FREQUENCIES
      for (let k = 0; k < FREQUENCIES; k++)
        weights[row + k]! += (longer[k]! - longer[k + 1]!) / ABSCISSAE
    }
    let sum = 0
    this.#cumulative = weights.map((weight) => (sum += weight)).map((below) => below / sum)
  }

  /** All cells first, then where in them orientations lie, then frequencies: the order in which numpy draws. */
  *sample(random: NumpyRandom, count: number): Work<DrawnGratings> {
    const cells = new Int32Array(count)
    const orientation = new Float64Array(count)
    const frequency = new Float64Array(count)
    for (let i = 0; i < count; i++) {
      if (i % AT_ONCE === 0) yield i / (3 * count)
      cells[i] = this.#cellOf(random.next())
    }
    for (let i = 0; i < count; i++) {
      if (i % AT_ONCE === 0) yield (count + i) / (3 * count)
      const row = Math.floor(cells[i]! / FREQUENCIES)
      orientation[i] = within(this.#orientations, row, random.next())
    }
    for (let i = 0; i < count; i++) {
      if (i % AT_ONCE === 0) yield (2 * count + i) / (3 * count)
      frequency[i] = within(this.#frequencies, cells[i]! % FREQUENCIES, random.next())
    }
    return { orientation, frequency }
  }

  /** The first cell up to which the sum is above a share. */
  #cellOf(share: number): number {
    let [low, high] = [0, this.#cumulative.length - 1]
    while (low < high) {
      const middle = (low + high) >> 1
      if (this.#cumulative[middle]! > share) high = middle
      else low = middle + 1
    }
    return low
  }
}

function within(edges: readonly number[], cell: number, share: number): number {
  return edges[cell]! + (edges[cell + 1]! - edges[cell]!) * share
}

/** Edges of so many equal cells. */
function linspace(first: number, last: number, cells: number): number[] {
  const step = (last - first) / cells
  return Array.from({ length: cells + 1 }, (_, i) => (i === cells ? last : first + i * step))
}
