import { parameterFromTexel } from '../../../web/maps/axes'
import { arrayOf, constantOf, type LoadedMap } from '../../../web/maps/load'

/** Numbers a cell has in the map: X, Y, Z in light of each of three bases. */
const COLUMNS = 9

/** Linear sRGB, or XYZ. */
export type Colour = [number, number, number]

/** The visible spectrum by 1 nm, as a map of kind 'lobes' weighs it for the eye. */
export class LightSpectrum {
  /** Middles of the cells, µm. */
  readonly wavelengths: readonly number[]
  /** X, Y, Z of each cell in white light; a mirror's white has Y = 1. */
  readonly #white: Float64Array
  /** The parts of each cell's white light that the bases red, green and blue have (Mallett and Yuksel 2019). */
  readonly #bases: Float64Array
  readonly #xyzToRgb: readonly number[]

  constructor(lobes: LoadedMap) {
    const { spec, data } = arrayOf(lobes, 'weights')
    const axis = spec.axes[0]!
    const count = axis.size - 1
    this.wavelengths = Array.from({ length: count }, (_, i) => {
      return (parameterFromTexel(axis, i) + parameterFromTexel(axis, i + 1)) / 2
    })
    this.#white = new Float64Array(3 * count)
    this.#bases = new Float64Array(3 * count)
    for (let cell = 0; cell < count; cell++) {
      let total = 0
      for (let column = 0; column < COLUMNS; column++) {
        const at = COLUMNS * cell + column
        const weight = data[at + COLUMNS]! - data[at]!
        this.#white[3 * cell + (column % 3)]! += weight
        this.#bases[3 * cell + Math.floor(column / 3)]! += weight
        total += weight
      }
      for (let tint = 0; tint < 3; tint++) {
        const at = 3 * cell + tint
        this.#bases[at] = total > 0 ? this.#bases[at]! / total : 1 / 3
      }
    }
    this.#xyzToRgb = constantOf(lobes, 'xyz_to_rgb')
  }

  /** XYZ of a cell in white light. */
  white(cell: number): Colour {
    const at = 3 * cell
    return [this.#white[at]!, this.#white[at + 1]!, this.#white[at + 2]!]
  }

  /** The part of white light at a cell that a basis (0: red, 1: green, 2: blue) has, 0 to 1. */
  basis(cell: number, tint: number): number {
    return this.#bases[3 * cell + tint]!
  }

  /**
   * The colour of light whose spectrum is the illuminant's times these factors, one for each cell.
   *
   * @returns linear sRGB, possibly out of gamut
   */
  colour(factors: ArrayLike<number>): Colour {
    const xyz: Colour = [0, 0, 0]
    for (let cell = 0; cell < this.wavelengths.length; cell++)
      for (let c = 0; c < 3; c++) xyz[c]! += this.#white[3 * cell + c]! * factors[cell]!
    return this.rgb(xyz)
  }

  /** Linear sRGB, white for a perfect mirror. */
  rgb(xyz: Colour): Colour {
    const m = this.#xyzToRgb
    const row = (r: number): number => m[r]! * xyz[0] + m[r + 1]! * xyz[1] + m[r + 2]! * xyz[2]
    return [row(0), row(3), row(6)]
  }
}

/** CIE standard illuminant A: a Planckian spectrum, 1 at 560 nm (CIE 015:2018). wavelength: µm. */
export function illuminantA(wavelength: number): number {
  const nm = 1000 * wavelength
  const planck = (λ: number): number => λ ** -5 / Math.expm1(1.435e7 / (2848 * λ))
  return planck(nm) / planck(560)
}

/** Cells over which a quotient of weights is taken: at the spectrum's ends one has few digits. */
const SMOOTHING = 2

/**
 * The relative spectral power of an illuminant, 1 at its largest. The maps hold it times the observer's functions only; but
 * those cancel against the map of illuminant A, whose spectrum is known.
 *
 * @param a - of illuminant A and the same observer
 */
export function illuminantSpectrum(light: LightSpectrum, a: LightSpectrum): Float64Array {
  const last = light.wavelengths.length - 1
  const near = (spectrum: LightSpectrum, cell: number): number => {
    let sum = 0
    for (let i = Math.max(cell - SMOOTHING, 0); i <= Math.min(cell + SMOOTHING, last); i++)
      sum += spectrum.white(i).reduce((total, weight) => total + weight, 0)
    return sum
  }
  const power = Float64Array.from(
    light.wavelengths,
    (wavelength, i) => (near(light, i) / near(a, i)) * illuminantA(wavelength),
  )
  const most = Math.max(...power)
  return power.map((value) => value / most)
}
