import { normalCdf } from '../../numbers/normal-cdf'
import { CHANNELS, EnvironmentCells } from './environment-cells'
import type { LocalEnvironment } from './environment-light'
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
 * An environment as a rough surface carries it over to one viewer: at (x, y) = (ω_i)_tb the mean of its radiance over tilts,
 * which move (x, y) by wδ times a standard normal pair, w = (ω_i + ω_o)_n, and are held at the horizon (docs/theory.md,
 * section 6).
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
  readonly #sharesY: Float64Array
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
    this.#sharesY = new Float64Array(this.#cells?.rows ?? 0)
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
      this.#workOut(
        Math.sin(this.#ψ + i * this.#step),
        Math.sin(this.#β + j * this.#step),
        3 * node,
      )
    }
    return 3 * node
  }

  /** The mean over tilts at (x, y), that may lie beyond the horizon. at: where its three numbers go. */
  #workOut(x: number, y: number, at: number): void {
    const z = Math.sqrt(Math.max(1 - x * x - y * y, 0))
    const narrowest = NARROWEST * this.#cells!.step
    const deviation = Math.max(this.roughness * (this.wo[2] + z), narrowest)
    const nodes = this.#nodes
    const held = this.#holdAtHorizon(x, y, deviation)
    const total = this.#sumUnderGaussian(x, y, deviation, at)
    const above = total > 0 ? (1 - held) / total : 0
    const atHorizon = total > 0 || held === 0 ? 1 : 1 / held
    for (let c = 0; c < 3; c++) nodes[at + c] = above * nodes[at + c]! + atHorizon * this.#held[c]!
  }

  /** Σ of the cells' light under a Gaussian about (x, y), to three nodes' numbers; returns Σ of the Gaussian. */
  #sumUnderGaussian(x: number, y: number, deviation: number, at: number): number {
    const cells = this.#cells!
    const { columns, rows, firstRow, sines, cells: light } = cells
    const reach = REACH * deviation
    const first = Math.max(Math.ceil(cells.at(x - reach)), 0)
    const last = Math.min(Math.floor(cells.at(x + reach)), columns - 1)
    const low = Math.max(Math.ceil(cells.at(y - reach)) - firstRow, 0)
    const high = Math.min(Math.floor(cells.at(y + reach)) - firstRow, rows - 1)
    cells.read(first, last)
    const sharpness = -0.5 / deviation ** 2
    for (let j = low; j <= high; j++)
      this.#sharesY[j] = Math.exp(sharpness * (sines[j + firstRow]! - y) ** 2)
    const sharesY = this.#sharesY
    let red = 0
    let green = 0
    let blue = 0
    let total = 0
    for (let i = first; i <= last; i++) {
      let r = 0
      let g = 0
      let b = 0
      let size = 0
      let cell = CHANNELS * (i * rows + low)
      for (let j = low; j <= high; j++, cell += CHANNELS) {
        const share = sharesY[j]!
        r += share * light[cell]!
        g += share * light[cell + 1]!
        b += share * light[cell + 2]!
        size += share * light[cell + 3]!
      }
      const share = Math.exp(sharpness * (sines[i]! - x) ** 2)
      red += share * r
      green += share * g
      blue += share * b
      total += share * size
    }
    this.#nodes[at] = red
    this.#nodes[at + 1] = green
    this.#nodes[at + 2] = blue
    return total
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
    const middle = Math.atan2(y, x)
    const widest = Math.asin(Math.min((REACH * deviation) / r, 1))
    const parts = Math.ceil((2 * widest) / Math.min(this.environment.texel / 2, 0.75 * deviation))
    const step = (2 * widest) / parts
    let total = 0
    for (let i = 0; i < parts; i++) {
      const α = (i + 0.5) * step - widest
      const a = r * Math.cos(α)
      const beyond =
        deviation * Math.exp(-0.5 * ((1 - a) / deviation) ** 2) +
        Math.sqrt(2 * Math.PI) * a * normalCdf((a - 1) / deviation)
      const share =
        (step * Math.exp(-0.5 * ((r * Math.sin(α)) / deviation) ** 2) * beyond) /
        (2 * Math.PI * deviation)
      total += share
      this.environment.add(Math.cos(middle + α), Math.sin(middle + α), 0, share, this.#held)
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
