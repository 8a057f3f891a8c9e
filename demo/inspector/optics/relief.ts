import { arrayOf, constantOf, valuesOf, type LoadedMap } from '../../../web/maps/load'
import { windowVariance } from '../../../web/spectrum/spectrum-optics'
import { kirchhoffFactor } from './kirchhoff'
import { gaussian, lobeCovariance, type Widening } from './lobe'
import { sumOf, type Direction } from './orders'

/** A line of a relief's spectrum: number along x, number along y. */
export type Line = readonly [j: number, l: number]

/** The spectrum of a repeating relief, as its map of kind 'height-field-terms' holds it (docs/theory/height-fields.md). */
export class Relief {
  /** Periods of the patch along x and y, µm. */
  readonly patch: readonly [number, number]
  /** Lines to either side of 0 along x and y. */
  readonly lines: readonly [number, number]
  readonly #terms: Float32Array
  readonly #coefficients: Float32Array
  readonly #samples: number
  readonly #count: number
  readonly #pairs: number
  readonly #amplitude: number
  readonly #maxPhase: number

  constructor(map: LoadedMap) {
    const terms = arrayOf(map, 'terms')
    const coefficients = arrayOf(map, 'coefficients')
    const [pairs, rows, columns] = terms.spec.shape as [number, number, number]
    const constant = (name: string): number => constantOf(map, name)[0]!
    this.patch = [constant('period_x'), constant('period_y')]
    this.lines = [columns - 1, (rows - 1) / 2]
    this.#terms = valuesOf(terms)
    this.#coefficients = valuesOf(coefficients)
    this.#count = coefficients.spec.shape[0]!
    this.#samples = coefficients.spec.shape[1]!
    this.#pairs = pairs
    this.#amplitude = constant('amplitude')
    this.#maxPhase = constant('max_phase')
  }

  /** Spatial frequency of a line along the patch's axes, 1/µm. */
  frequency([j, l]: Line): [number, number] {
    return [j / this.patch[0], l / this.patch[1]]
  }

  /**
   * |A_jl|² of lines at one depth: w, the sum of both cosines, and the wavelength in µm. The coefficients are looked up once
   * for all lines.
   */
  powers(w: number, wavelength: number): (line: Line) => number {
    const c = this.#coefficientsAt((2 * Math.PI * w * this.#amplitude) / wavelength)
    const [across, along] = this.lines
    return ([j, l]) => {
      // Half a plane is stored; the factor iⁿ is not conjugated with the other half.
      const sign = j < 0 ? -1 : 1
      if (Math.abs(j) > across || Math.abs(l) > along) return 0
      const texel = (sign * l + along) * (across + 1) + sign * j
      const stride = (2 * along + 1) * (across + 1)
      let [evenRe, evenIm, oddRe, oddIm] = [0, 0, 0, 0]
      for (let pair = 0; pair < this.#pairs; pair++) {
        const at = 4 * (pair * stride + texel)
        const [even, odd] = [c[2 * pair]!, c[2 * pair + 1] ?? 0]
        evenRe += even * this.#terms[at]!
        evenIm += even * this.#terms[at + 1]!
        oddRe += odd * this.#terms[at + 2]!
        oddIm += odd * this.#terms[at + 3]!
      }
      const re = evenRe + sign * oddRe
      const im = evenIm + sign * oddIm
      return re * re + im * im
    }
  }

  #coefficientsAt(x: number): Float64Array {
    const column = Math.min(x / this.#maxPhase, 1) * (this.#samples - 1)
    const low = Math.min(Math.floor(column), this.#samples - 2)
    return Float64Array.from({ length: this.#count }, (_, n) => {
      const at = n * this.#samples + low
      const value = this.#coefficients[at]!
      return value + (column - low) * (this.#coefficients[at + 1]! - value)
    })
  }
}

/** A relief, and how its light is counted. */
export interface ReliefOptics extends Widening {
  relief: Relief
  /** R of metal, or Fresnel's of a dielectric; λ in µm. */
  reflectance: (wavelength: number, wi: Direction, wo: Direction) => number
  /** Whether relative to a flat surface at normal incidence, or in 1/sr. */
  isRelative: boolean
}

/** Lobes are looked at to this many standard deviations. */
const REACH = 5.3

/** f_r(ω_i, ω_o, λ) by the powers of the lines, blurred by a light of some size (docs/theory/height-fields.md). */
export function reliefBrdf(
  { relief, reflectance, isRelative, ...widening }: ReliefOptics,
  wi: Direction,
  wo: Direction,
  wavelength: number,
  angularRadius: number,
): number {
  if (!(wi[2] > 0 && wo[2] > 0)) return 0
  const [u, v, w] = sumOf(wi, wo)
  const s = 1 / wavelength
  const c = lobeCovariance(widening, wi, w, angularRadius, wavelength)
  const power = relief.powers(w, wavelength)
  const range = (at: number, deviation: number, patch: number, limit: number): number[] => {
    const first = Math.max(Math.ceil((at - REACH * deviation) * s * patch), -limit)
    const last = Math.min(Math.floor((at + REACH * deviation) * s * patch), limit)
    return Array.from({ length: Math.max(last - first + 1, 0) }, (_, i) => first + i)
  }
  let density = 0
  for (const j of range(u, Math.sqrt(c.uu), relief.patch[0], relief.lines[0]))
    for (const l of range(v, Math.sqrt(c.vv), relief.patch[1], relief.lines[1])) {
      const [fx, fy] = relief.frequency([j, l])
      density += power([j, l]) * gaussian(c, u - wavelength * fx, v - wavelength * fy)
    }
  // N over (u, v) is s² times that over spatial frequency.
  const scale = isRelative ? 2 * Math.PI * windowVariance(widening.coherence) * wavelength ** 2 : 1
  return reflectance(wavelength, wi, wo) * kirchhoffFactor(wi, wo) * density * scale
}

/** A line, and the share |A|² of the light that it takes. */
export interface PoweredLine {
  line: Line
  power: number
}

/** Lines that are kept of each spectrum, as many as pictures show, and steps of w in which they are: what is smaller is not seen. */
const MOST_LINES = 13
const STEPS_OF_W = 100

const strongest = new WeakMap<Relief, Map<string, readonly PoweredLine[]>>()

/** The lines that take most of the light about that depth, the strongest first, 13 at most. w: cosθ_i + cosθ_o. */
export function strongestLines(
  relief: Relief,
  w: number,
  wavelength: number,
): readonly PoweredLine[] {
  let known = strongest.get(relief)
  if (known === undefined)
    strongest.set(relief, (known = new Map<string, readonly PoweredLine[]>()))
  const step = Math.round(STEPS_OF_W * Math.max(w, 0))
  const key = `${step} ${wavelength}`
  let lines = known.get(key)
  if (lines === undefined)
    known.set(key, (lines = foundLines(relief, step / STEPS_OF_W, wavelength)))
  return lines
}

function foundLines(relief: Relief, w: number, wavelength: number): PoweredLine[] {
  const power = relief.powers(w, wavelength)
  const [across, along] = relief.lines
  const found: PoweredLine[] = []
  for (let j = -across; j <= across; j++)
    for (let l = -along; l <= along; l++) {
      const share = power([j, l])
      if (share > 1e-5) found.push({ line: [j, l], power: share })
    }
  return found.sort((a, b) => b.power - a.power).slice(0, MOST_LINES)
}
