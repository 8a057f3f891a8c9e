import type { Steps } from '../../../web/steps'
import type { Relief } from './relief'

/** The shortest visible wavelength, µm: no line is lit beyond 2/λ, and w/λ is no larger. */
const LONGEST = 2 / 0.38
/** Steps of w/λ, between which cubics are exact to 2e-5 of all light for reliefs of 0.3 µm. */
const STEPS = 64
/** Lines are left out that together never take more than this share of the light. */
const REST = 3e-4

/** Lines that can be lit, |A|² of each at all steps, one line after the other, and the largest of each. */
interface Sampled {
  reachable: readonly [j: number, l: number][]
  all: Float32Array
  largest: Float64Array
}

function* sampled(relief: Relief): Steps<Sampled> {
  const [across, along] = relief.lines
  const reachable: [j: number, l: number][] = []
  for (let j = -across; j <= across; j++)
    for (let l = -along; l <= along; l++)
      if (Math.hypot(...relief.frequency([j, l])) < LONGEST) reachable.push([j, l])
  const samples = STEPS + 1
  const all = new Float32Array(reachable.length * samples)
  const largest = new Float64Array(reachable.length)
  for (let step = 0; step < samples; step++) {
    yield
    const power = relief.powers((step * LONGEST) / STEPS, 1)
    reachable.forEach((line, i) => {
      const value = power(line)
      all[i * samples + step] = value
      largest[i] = Math.max(largest[i]!, value)
    })
  }
  return { reachable, all, largest }
}

/** |A_jl|² of the lines that matter over w/λ, on which alone it depends: a table, made once of each relief. */
export class LinePowers {
  readonly count: number
  /** f of each line along the patch's x and y, 1/µm; the strongest line first. */
  readonly fx: Float64Array
  readonly fy: Float64Array
  /** The largest share of the light that each ever takes. */
  readonly largest: Float64Array
  readonly #powers: Float32Array

  constructor(relief: Relief, { reachable, all, largest }: Sampled) {
    const samples = STEPS + 1
    const order = Array.from(reachable.keys()).sort((a, b) => largest[b]! - largest[a]!)
    for (let rest = 0; order.length > 0; order.pop()) {
      rest += largest[order.at(-1)!]!
      if (rest > REST) break
    }
    this.count = order.length
    this.fx = Float64Array.from(order, (i) => relief.frequency(reachable[i]!)[0])
    this.fy = Float64Array.from(order, (i) => relief.frequency(reachable[i]!)[1])
    this.largest = Float64Array.from(order, (i) => largest[i]!)
    this.#powers = new Float32Array(order.length * samples)
    order.forEach((from, to) => {
      this.#powers.set(all.subarray(from * samples, (from + 1) * samples), to * samples)
    })
  }

  /** |A|² of a line. p: w/λ, 1/µm. */
  at(line: number, p: number): number {
    const step = (p * STEPS) / LONGEST
    const first = Math.min(Math.max(Math.floor(step) - 1, 0), STEPS - 3)
    const t = step - first - 1
    const powers = this.#powers
    const i = line * (STEPS + 1) + first
    // Lagrange's cubic through four of the table's values.
    return (
      (t + 1) * (t - 1) * (t - 2) * 0.5 * powers[i + 1]! -
      (t * (t - 1) * (t - 2) * powers[i]!) / 6 -
      (t + 1) * t * (t - 2) * 0.5 * powers[i + 2]! +
      ((t + 1) * t * (t - 1) * powers[i + 3]!) / 6
    )
  }
}

const known = new WeakMap<Relief, LinePowers>()

/** The table of a relief; no step where it was made before. */
export function* linePowers(relief: Relief): Steps<LinePowers> {
  let powers = known.get(relief)
  if (powers === undefined)
    known.set(relief, (powers = new LinePowers(relief, yield* sampled(relief))))
  return powers
}
