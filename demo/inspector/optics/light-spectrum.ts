import { parameterFromTexel } from '../../../web/maps/axes'
import { arrayOf, constantOf, type LoadedMap } from '../../../web/maps/load'

const COLUMNS = 9

/** Linear sRGB, or XYZ. */
export type Colour = [number, number, number]

/** The visible spectrum by 1 nm, as a map of kind 'lobes' weighs it for the eye. */
export class LightSpectrum {
  /** Middles of the cells, µm. */
  readonly wavelengths: readonly number[]
  /** Of each cell: XYZ in light of the bases red, green and blue, whose sum is white; a mirror's white has Y = 1. */
  readonly #weights: Float64Array
  readonly #xyzToRgb: readonly number[]

  constructor(lobes: LoadedMap) {
    const { spec, data } = arrayOf(lobes, 'weights')
    const axis = spec.axes[0]!
    this.wavelengths = Array.from({ length: axis.size - 1 }, (_, i) => {
      return (parameterFromTexel(axis, i) + parameterFromTexel(axis, i + 1)) / 2
    })
    this.#weights = Float64Array.from(
      { length: COLUMNS * this.wavelengths.length },
      (_, i) => data[i + COLUMNS]! - data[i]!,
    )
    this.#xyzToRgb = constantOf(lobes, 'xyz_to_rgb')
  }

  /** XYZ of a cell in white light. */
  white(cell: number): Colour {
    const at = (c: number): number =>
      this.#weight(cell, c) + this.#weight(cell, c + 3) + this.#weight(cell, c + 6)
    return [at(0), at(1), at(2)]
  }

  /** The part of white light at a cell that a basis (0: red, 1: green, 2: blue) has, 0 to 1 (Mallett and Yuksel 2019). */
  basis(cell: number, tint: number): number {
    const sum = (from: number): number =>
      this.#weight(cell, from) + this.#weight(cell, from + 1) + this.#weight(cell, from + 2)
    const white = sum(0) + sum(3) + sum(6)
    return white > 0 ? sum(3 * tint) / white : 1 / 3
  }

  /**
   * The colour of light whose spectrum is the illuminant's times these factors.
   *
   * @param factors - one for each `stride`-th cell
   * @returns linear sRGB, possibly out of gamut
   */
  colour(factors: ArrayLike<number>, stride = 1): Colour {
    const xyz = [0, 0, 0]
    for (let i = 0; i < factors.length; i++) {
      // Cells between two factors have the nearer one's.
      const first = Math.max(i * stride - (stride >> 1), 0)
      const last = Math.min(i * stride + ((stride - 1) >> 1), this.wavelengths.length - 1)
      for (let cell = first; cell <= last; cell++)
        this.white(cell).forEach((weight, c) => (xyz[c]! += weight * factors[i]!))
    }
    return this.rgb(xyz as Colour)
  }

  /** Linear sRGB, white for a perfect mirror. */
  rgb(xyz: Colour): Colour {
    const m = this.#xyzToRgb
    const row = (r: number): number => m[r]! * xyz[0] + m[r + 1]! * xyz[1] + m[r + 2]! * xyz[2]
    return [row(0), row(3), row(6)]
  }

  #weight(cell: number, column: number): number {
    return this.#weights[COLUMNS * cell + column]!
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
