import type { NumpyRandom } from './numpy-random'
import type { Work } from './work'

const AT_ONCE = 1024

/** Orientations, rad, and 1/period, 1/µm, of gratings one by one. */
export interface DrawnGratings {
  orientation: Float64Array
  frequency: Float64Array
}

/** How often which gratings occur, as `precompute.foils.distribution.GratingDistribution` has it; within a cell all are as likely. */
export class GratingDistribution {
  /** The sum of shares up to each cell, orientation by orientation. */
  readonly #cumulative: Float64Array

  /**
   * @param orientationEdges - of cells, rad, rising
   * @param frequencyEdges - of cells, 1/µm, rising
   * @param weights - of cells, orientation by orientation; one above 0 at least
   */
  constructor(
    private readonly orientationEdges: readonly number[],
    private readonly frequencyEdges: readonly number[],
    weights: Float64Array,
  ) {
    // The largest first, so that no sum overflows.
    const most = weights.reduce((a, b) => Math.max(a, b))
    let sum = 0
    this.#cumulative = weights.map((weight) => (sum += weight / most)).map((below) => below / sum)
  }

  /** All cells first, then where in them orientations lie, then frequencies: the order in which numpy draws. */
  *sample(random: NumpyRandom, count: number): Work<DrawnGratings> {
    const frequencies = this.frequencyEdges.length - 1
    const cells = new Int32Array(count)
    const orientation = new Float64Array(count)
    const frequency = new Float64Array(count)
    for (let i = 0; i < count; i++) {
      if (i % AT_ONCE === 0) yield i / (3 * count)
      cells[i] = this.#cellOf(random.next())
    }
    for (let i = 0; i < count; i++) {
      if (i % AT_ONCE === 0) yield (count + i) / (3 * count)
      const row = Math.floor(cells[i]! / frequencies)
      orientation[i] = within(this.orientationEdges, row, random.next())
    }
    for (let i = 0; i < count; i++) {
      if (i % AT_ONCE === 0) yield (2 * count + i) / (3 * count)
      frequency[i] = within(this.frequencyEdges, cells[i]! % frequencies, random.next())
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
