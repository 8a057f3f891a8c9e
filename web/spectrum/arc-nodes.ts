import { parameterFromTexel } from '../maps/axes.ts'
import { arrayOf, type LoadedMap } from '../maps/load.ts'
import { radicalInverse } from '../refinement/radical-inverse.ts'
import { product, solvePositive } from './solve-positive.ts'
import type { SpectralNode } from './spectral-nodes.ts'

/** XYZ in light of each of the three tint bases. */
const COLUMNS = 9

/**
 * How fast radiance is taken to change along an arc: the mean square of its difference between two wavelengths grows
 * with their distance to the power of 1.5. 1 is a path of edges, 2 a smooth one.
 */
function variogram(a: number, b: number): number {
  const distance = Math.abs(a - b)
  return distance * Math.sqrt(distance)
}

/** Share of the nodes that is spread evenly over the spectrum, so that none of its dim ends goes without. */
const EVEN_SHARE = 0.1

/** One nanometre of the spectrum. */
interface Cell {
  /** Its middle, µm. */
  wavelength: number
  /** Its width, µm. */
  width: number
  /** XYZ in light of the three tint bases, seen in the metal. */
  tints: number[]
}

/**
 * Wavelengths at which the arcs of an environment are read, and the weights by which the readings stand for the whole
 * spectrum: the linear estimate of ∫ W R L dλ that errs least on average over all radiances L(λ) whose differences
 * grow as `variogram` says, and not at all where L is the same everywhere (ordinary kriging, Matheron 1963). Nodes are at
 * the centroids of bands whose density goes with the root of the weight: the error of a band grows with its weight
 * times the square of its width.
 *
 * Over several frames, each with nodes of its own in between those of the others, the mean of the frames is nearly
 * the estimate of all nodes together, and each frame alone is exact where L is the same everywhere.
 *
 * @param lobes - a map of kind 'lobes'
 * @param count - number of nodes of a frame, 1 or more
 * @param reflectance - R(λ) of the metal, λ in µm; the nodes' tints come with it
 * @param frames - number of frames, a power of 2
 * @returns the nodes of one frame after the other's; the mean of the first 2, 4, 8 … frames spreads evenly
 */
export function arcNodes(
  lobes: LoadedMap,
  count: number,
  reflectance: (wavelength: number) => number,
  frames = 1,
): SpectralNode[] {
  const cells = spectrumCells(lobes, reflectance)
  const nodes = bandNodes(cells, count * frames)
  const wavelengths = nodes.map((node) => node.wavelength)
  const tints = estimatorWeights(cells, wavelengths, frames)
  return Array.from({ length: frames }, (_, frame) => {
    // The first in the middle of each frame's bands.
    const place = (radicalInverse(frame) * frames + frames / 2) % frames
    return Array.from({ length: count }, (_, band) => {
      const i = band * frames + Math.floor(place)
      return { ...nodes[i]!, tints: tints[i]!.map((tint) => tint * frames) }
    })
  }).flat()
}

function spectrumCells(
  lobes: LoadedMap,
  reflectance: (wavelength: number) => number,
): readonly Cell[] {
  const { spec, data } = arrayOf(lobes, 'weights')
  const axis = spec.axes[0]!
  return Array.from({ length: axis.size - 1 }, (_, i) => {
    const [low, high] = [parameterFromTexel(axis, i), parameterFromTexel(axis, i + 1)]
    const wavelength = (low + high) / 2
    const seen = reflectance(wavelength)
    const tints = Array.from(
      { length: COLUMNS },
      (_, c) => seen * (data[(i + 1) * COLUMNS + c]! - data[i * COLUMNS + c]!),
    )
    return { wavelength, width: high - low, tints }
  })
}

/** Bands side by side over the spectrum, each with a node at the centroid of its weight. */
function bandNodes(cells: readonly Cell[], count: number): Omit<SpectralNode, 'tints'>[] {
  const roots = cells.map(({ tints }) => Math.sqrt(Math.hypot(...tints)))
  const total = sum(roots)
  const density = new Cumulative(
    cells,
    roots.map((root) => ((1 - EVEN_SHARE) * root) / total + EVEN_SHARE / cells.length),
  )
  const weight = new Cumulative(
    cells,
    cells.map(({ tints }) => sum(tints)),
  )
  const edges = Array.from({ length: count + 1 }, (_, i) => density.inverse(i / count))
  return edges.slice(1).map((high, i) => {
    const low = edges[i]!
    const light = weight.at(high) - weight.at(low)
    const moment = weight.momentAt(high) - weight.momentAt(low)
    return { wavelength: light > 0 ? moment / light : (low + high) / 2, bandwidth: high - low }
  })
}

/**
 * The weights of a reading at each of those wavelengths, in µm, one of each frame in turn: nine numbers for each.
 *
 * An estimate that is exact where the radiance is the same everywhere is one of its differences from that at the first
 * wavelength. The covariances of these, here twice, are positive definite between the others; the first has the weight
 * that is left.
 */
function estimatorWeights(
  cells: readonly Cell[],
  [first, ...others]: readonly number[],
  frames: number,
): number[][] {
  const covariance = (a: number, b: number): number =>
    variogram(a, first!) + variogram(b, first!) - variogram(a, b)
  const lights = Array.from({ length: COLUMNS }, (_, c) =>
    new Float64Array(cells.length).map((_, cell) => cells[cell]!.tints[c]!),
  )
  const columns = lights.map(() => new Float64Array(others.length))
  const rows = others.map((a, i) => {
    const withCells = new Float64Array(cells.length).map((_, cell) =>
      covariance(a, cells[cell]!.wavelength),
    )
    lights.forEach((light, c) => (columns[c]![i] = product(withCells, light)))
    return new Float64Array(others.length).map((_, j) => (j < i ? 0 : covariance(a, others[j]!)))
  })
  solvePositive(rows, columns)
  const total = lights.map(sum)
  const weights = others.map((_, i) => columns.map((column) => column[i]!))
  const rest = total.map((amount, c) => amount - sum(columns[c]!))
  return shared([rest, ...weights], total, frames)
}

/**
 * Weights of which each frame's add up to an equal share of the total: some percent more or less in each. The dim ends of the
 * spectrum have some slightly below zero, at most 2 % of a sum; a lamp seen at one of these wavelengths alone would shine
 * darkness: they are zero, and the others as much less.
 */
function shared(weights: number[][], total: readonly number[], frames: number): number[][] {
  const kept = weights.map((tints) => tints.map((tint) => Math.max(tint, 0)))
  const factors = Array.from({ length: frames }, (_, frame) => {
    const own = kept.filter((_, i) => i % frames === frame)
    return total.map((amount, c) => amount / frames / sum(own.map((tints) => tints[c]!)))
  })
  return kept.map((tints, i) => tints.map((tint, c) => tint * factors[i % frames]![c]!))
}

/** The sum over cells up to a wavelength, each cell's amount spread evenly over it. */
class Cumulative {
  readonly #amounts: number[] = [0]
  readonly #moments: number[] = [0]

  constructor(
    private readonly cells: readonly Cell[],
    private readonly parts: readonly number[],
  ) {
    parts.forEach((part, i) => {
      this.#amounts.push(this.#amounts[i]! + part)
      this.#moments.push(this.#moments[i]! + part * cells[i]!.wavelength)
    })
  }

  at(wavelength: number): number {
    const { index, share } = this.#place(wavelength)
    return this.#amounts[index]! + share * this.parts[index]!
  }

  /** The sum of amounts times their wavelengths. */
  momentAt(wavelength: number): number {
    const { index, share, low } = this.#place(wavelength)
    return this.#moments[index]! + share * this.parts[index]! * ((low + wavelength) / 2)
  }

  /** The wavelength up to which the sum is that amount. */
  inverse(amount: number): number {
    const last = this.parts.length - 1
    const found = this.#amounts.findIndex((above, i) => i > 0 && above >= amount)
    const index = found < 0 ? last : found - 1
    const share = Math.min((amount - this.#amounts[index]!) / this.parts[index]!, 1)
    return this.#low(index) + share * this.cells[index]!.width
  }

  #place(wavelength: number): { index: number; share: number; low: number } {
    const { width } = this.cells[0]!
    const index = Math.floor((wavelength - this.#low(0)) / width)
    const held = Math.min(Math.max(index, 0), this.cells.length - 1)
    const low = this.#low(held)
    return { index: held, share: (wavelength - low) / width, low }
  }

  #low(index: number): number {
    return this.cells[index]!.wavelength - this.cells[index]!.width / 2
  }
}

function sum(values: readonly number[] | Float64Array): number {
  let total = 0
  for (const value of values) total += value
  return total
}
