import { normalCdf } from '../../numbers/normal-cdf'
import { CHANNELS, EnvironmentCells } from './environment-cells'
import type { LocalEnvironment } from './environment-light'
import { Horizon } from './horizon'
import type { Direction } from './orders'

/** Tilts are followed to so many standard deviations along t and b; the shares of those sum to 1. */
const REACH = 4
/** Tilts that move light by less than this part of a texel leave the environment as it is. */
const FLAT = 0.05
/** Step of nodes in standard deviations: between them a cubic is 0.2 % of a lone lamp's peak off. */
const NODE_STEP = 0.4
/** A Gaussian narrower than this part of a cell's step would miss their middles: near the horizon, seen at grazing angles. */
const NARROWEST = 0.3

/**
 * Ratio of the deviations for which cells are summed up along y, once for all nodes of a row: between two of them sums are
 * mixed to the right variance, 0.2 % of a lone lamp's peak off.
 */
const LEVEL_RATIO = 1.07

/** Step along the horizon in standard deviations. */
const HORIZON_STEP = 0.4

/** Sums of columns of cells along y under a Gaussian about one y. */
interface Strip {
  /** The first and the last of the rows that are kept which it reaches, and the Gaussian at each from the first on. */
  low: number
  high: number
  shares: Float64Array
  /** {@link CHANNELS} a column; of columns that have been summed up. */
  sums: Float32Array
  isKnown: Uint8Array
}

/**
 * An environment as a rough surface carries it over to one viewer: at (x, y) = (ω_i)_tb the mean of its radiance over tilts,
 * which move (x, y) by wδ times a standard normal pair, w = (ω_i + ω_o)_n, and are held at the horizon
 * (docs/theory/environments.md).
 *
 * It is worked out at nodes, even in asin x and asin y, each when it is first asked for: a sum over the environment's cells
 * under the Gaussian, and one along the horizon of what is held there. Between them run cubics.
 */
export class TiltedEnvironment {
  /** null where tilts are too small to matter. */
  readonly #cells: EnvironmentCells | null = null
  /** asin x and asin y of the node in the middle, where the mirror image is; step of nodes, rad. */
  readonly #ψ: number
  readonly #β: number
  readonly #step: number
  /** Nodes to either side of the middle one, along asin x and asin y. */
  readonly #across: number
  readonly #along: number
  readonly #nodes: Float64Array
  readonly #isKnown: Uint8Array
  readonly #horizon: Horizon
  readonly #strips = new Map<number, Strip>()
  readonly #held = new Float64Array(3)

  /**
   * @param wo - ω_o, above the horizon
   * @param roughness - δ, rad
   * @param isLine - whether only y = −(ω_o)_b is asked for, where the orders of a grating lie
   */
  constructor(
    private readonly environment: LocalEnvironment,
    private readonly wo: Direction,
    private readonly roughness: number,
    isLine: boolean,
  ) {
    const { texel } = environment
    this.#horizon = new Horizon(environment)
    // Along the line no cosine is larger than this, in all of the disc none than 1.
    const most = isLine ? Math.sqrt(1 - wo[1] * wo[1]) : 1
    const widest = roughness * (wo[2] + most)
    this.#ψ = -Math.asin(wo[0])
    this.#β = -Math.asin(wo[1])
    this.#step = NODE_STEP * widest
    if (widest >= FLAT * texel) {
      const step = Math.min(Math.max(widest / 4, texel / 2), texel, 0.75 * widest)
      const reach = isLine ? REACH * widest : 2
      this.#cells = new EnvironmentCells(environment, step, -wo[1] - reach, -wo[1] + reach)
    }
    const nodes = this.#cells === null ? 0 : Math.ceil(Math.PI / this.#step) + 2
    this.#across = nodes
    this.#along = isLine ? 0 : nodes
    this.#nodes = new Float64Array(3 * (2 * this.#across + 1) * (2 * this.#along + 1))
    this.#isKnown = new Uint8Array(this.#nodes.length / 3)
  }

  /**
   * Adds a share of the radiance at (x, y), within the unit disc, to three numbers of a sum: linear sRGB.
   *
   * @param at - index of the first
   */
  add(x: number, y: number, share: number, sum: Float64Array, at: number): void {
    if (this.#cells === null) {
      const z = Math.sqrt(Math.max(1 - x * x - y * y, 0))
      this.environment.add(x, y, z, share, sum, at)
      return
    }
    const i = (Math.asin(x) - this.#ψ) / this.#step
    const j = this.#along === 0 ? 0 : (Math.asin(y) - this.#β) / this.#step
    const [left, low] = [Math.floor(i), Math.floor(j)]
    const [s, t] = [i - left, j - low]
    for (let l = -1; l <= 2; l++) {
      const along = share * cubic(l, t)
      if (along === 0) continue
      for (let k = -1; k <= 2; k++) {
        const part = along * cubic(k, s)
        if (part === 0) continue
        const node = this.#node(left + k, low + l)
        for (let c = 0; c < 3; c++) sum[at + c]! += part * this.#nodes[node + c]!
      }
    }
  }

  /** Index of a node's three numbers. */
  #node(i: number, j: number): number {
    const node = (j + this.#along) * (2 * this.#across + 1) + i + this.#across
    if (!this.#isKnown[node]!) {
      this.#isKnown[node] = 1
      this.#workOut(Math.sin(this.#ψ + i * this.#step), j, 3 * node)
    }
    return 3 * node
  }

  /** The mean over tilts at x in a row of nodes, that may lie beyond the horizon. at: where its three numbers go. */
  #workOut(x: number, row: number, at: number): void {
    const y = Math.sin(this.#β + row * this.#step)
    const z = Math.sqrt(Math.max(1 - x * x - y * y, 0))
    const narrowest = NARROWEST * this.#cells!.step
    const deviation = Math.max(this.roughness * (this.wo[2] + z), narrowest)
    const nodes = this.#nodes
    const held = this.#holdAtHorizon(x, y, deviation)
    const total = this.#sumUnderGaussian(x, row, deviation, at)
    const above = total > 0 ? (1 - held) / total : 0
    const atHorizon = total > 0 || held === 0 ? 1 : 1 / held
    for (let c = 0; c < 3; c++) nodes[at + c] = above * nodes[at + c]! + atHorizon * this.#held[c]!
  }

  /** Σ of the cells' light under a Gaussian about a node, to its three numbers; returns Σ of the Gaussian. */
  #sumUnderGaussian(x: number, row: number, deviation: number, at: number): number {
    const cells = this.#cells!
    const { columns, sines } = cells
    const reach = REACH * deviation
    const first = Math.max(Math.ceil(cells.at(x - reach)), 0)
    const last = Math.min(Math.floor(cells.at(x + reach)), columns - 1)
    cells.read(first, last)
    const narrowest = NARROWEST * cells.step
    const level = Math.floor(Math.log(deviation / narrowest) / Math.log(LEVEL_RATIO))
    const variance = (narrowest * LEVEL_RATIO ** level) ** 2
    const wider = (deviation ** 2 / variance - 1) / (LEVEL_RATIO ** 2 - 1)
    const strip = this.#strip(row, level)
    const next = this.#strip(row, level + 1)
    const sharpness = -0.5 / deviation ** 2
    let red = 0
    let green = 0
    let blue = 0
    let total = 0
    for (let i = first; i <= last; i++) {
      const a = this.#column(strip, i)
      const b = this.#column(next, i)
      const share = Math.exp(sharpness * (sines[i]! - x) ** 2)
      const q = share * wider
      const p = share - q
      red += p * strip.sums[a]! + q * next.sums[b]!
      green += p * strip.sums[a + 1]! + q * next.sums[b + 1]!
      blue += p * strip.sums[a + 2]! + q * next.sums[b + 2]!
      total += p * strip.sums[a + 3]! + q * next.sums[b + 3]!
    }
    this.#nodes[at] = red
    this.#nodes[at + 1] = green
    this.#nodes[at + 2] = blue
    return total
  }

  #strip(row: number, level: number): Strip {
    const key = row * 1024 + level
    const known = this.#strips.get(key)
    if (known !== undefined) return known
    const cells = this.#cells!
    const { columns, rows, firstRow, sines, step } = cells
    const y = Math.sin(this.#β + row * this.#step)
    const deviation = NARROWEST * step * LEVEL_RATIO ** level
    const low = Math.max(Math.ceil(cells.at(y - REACH * deviation)) - firstRow, 0)
    const high = Math.min(Math.floor(cells.at(y + REACH * deviation)) - firstRow, rows - 1)
    const strip = {
      ...{ low, high },
      // As a density, so that two of them can be mixed.
      shares: Float64Array.from(
        { length: Math.max(high - low + 1, 0) },
        (_, j) => Math.exp(-0.5 * ((sines[low + j + firstRow]! - y) / deviation) ** 2) / deviation,
      ),
      sums: new Float32Array(CHANNELS * columns),
      isKnown: new Uint8Array(columns),
    }
    this.#strips.set(key, strip)
    return strip
  }

  /** Index of the sums of a column, which has been read. */
  #column(strip: Strip, column: number): number {
    const at = CHANNELS * column
    if (strip.isKnown[column]!) return at
    strip.isKnown[column] = 1
    const { rows, cells: light } = this.#cells!
    const { low, high, shares, sums } = strip
    let r = 0
    let g = 0
    let b = 0
    let size = 0
    let cell = CHANNELS * (column * rows + low)
    for (let j = low; j <= high; j++, cell += CHANNELS) {
      const share = shares[j - low]!
      r += share * light[cell]!
      g += share * light[cell + 1]!
      b += share * light[cell + 2]!
      size += share * light[cell + 3]!
    }
    sums[at] = r
    sums[at + 1] = g
    sums[at + 2] = b
    sums[at + 3] = size
    return at
  }

  /**
   * The light that tilts about (x, y) hold at the horizon; returns their share. With r the distance and α the angle from
   * (x, y), a = r cos α and ς the deviation, the Gaussian beyond the horizon is, per angle,
   * exp(−r² sin²α/2ς²)/(2πς²) · (ς² exp(−(1 − a)²/2ς²) + √(2π) ς a Φ((a − 1)/ς)).
   */
  #holdAtHorizon(x: number, y: number, deviation: number): number {
    this.#held.fill(0)
    const r = Math.hypot(x, y)
    if (1 - r > REACH * deviation) return 0
    const widest = Math.asin(Math.min((REACH * deviation) / r, 1))
    const parts = Math.ceil((2 * widest) / (HORIZON_STEP * deviation))
    const step = (2 * widest) / parts
    const first = Math.atan2(y, x) - widest
    let total = 0
    for (let i = 0; i < parts; i++) {
      const α = (i + 0.5) * step - widest
      const a = r * Math.cos(α)
      const beyond =
        deviation * Math.exp(-0.5 * ((1 - a) / deviation) ** 2) +
        Math.sqrt(2 * Math.PI) * a * normalCdf((a - 1) / deviation)
      const density =
        (Math.exp(-0.5 * ((r * Math.sin(α)) / deviation) ** 2) * beyond) / (2 * Math.PI * deviation)
      total += step * density
      this.#horizon.add(first + i * step, first + (i + 1) * step, density, this.#held)
    }
    return total
  }
}

/** Lagrange's cubic through nodes −1 to 2: what node k counts at t, from 0 to 1. */
function cubic(k: number, t: number): number {
  switch (k) {
    case -1:
      return (-t * (t - 1) * (t - 2)) / 6
    case 0:
      return ((t + 1) * (t - 1) * (t - 2)) / 2
    case 1:
      return (-(t + 1) * t * (t - 2)) / 2
    default:
      return ((t + 1) * t * (t - 1)) / 6
  }
}
