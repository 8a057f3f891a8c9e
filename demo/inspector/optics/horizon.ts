import type { LocalEnvironment } from './environment-light'

/** The environment along a surface's horizon, to be averaged over angles. It is read when it is first asked for. */
export class Horizon {
  readonly #environment: LocalEnvironment
  /** Readings, two a texel. */
  readonly #count: number
  /** ∫ L dφ from 0 to each reading's beginning, R, G, B; once round. */
  #integral: Float64Array | null = null

  constructor(environment: LocalEnvironment) {
    this.#environment = environment
    this.#count = Math.ceil((4 * Math.PI) / environment.texel)
  }

  /** Adds share · ∫ L dφ to three numbers of linear sRGB. from, to: angles from t towards b, rad, less than a turn apart. */
  add(from: number, to: number, share: number, sum: Float64Array): void {
    const integral = (this.#integral ??= this.#read())
    this.#addUpTo(integral, to, share, sum)
    this.#addUpTo(integral, from, -share, sum)
  }

  /** Of turns, the whole ones too. */
  #addUpTo(integral: Float64Array, angle: number, share: number, sum: Float64Array): void {
    const place = (angle / (2 * Math.PI)) * this.#count
    const whole = Math.floor(place)
    const turns = Math.floor(whole / this.#count)
    const at = 3 * (whole - turns * this.#count)
    const end = 3 * this.#count
    for (let c = 0; c < 3; c++) {
      const low = integral[at + c]!
      const within = low + (place - whole) * (integral[at + 3 + c]! - low)
      sum[c]! += share * (turns * integral[end + c]! + within)
    }
  }

  #read(): Float64Array {
    const integral = new Float64Array(3 * (this.#count + 1))
    const step = (2 * Math.PI) / this.#count
    for (let i = 0; i < this.#count; i++) {
      const at = 3 * (i + 1)
      for (let c = 0; c < 3; c++) integral[at + c] = integral[at - 3 + c]!
      const φ = (i + 0.5) * step
      this.#environment.add(Math.cos(φ), Math.sin(φ), 0, step, integral, at)
    }
    return integral
  }
}
