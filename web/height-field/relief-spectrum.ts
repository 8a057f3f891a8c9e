import { texelFromParameter } from '../maps/axes.ts'
import { arrayOf, valuesOf, type LoadedMap } from '../maps/load.ts'

/** Power of a cell at p = w/λ, linear between the map's samples. */
export type CellPower = (cell: number, p: number) => number

/** The cells of a relief's spectrum. */
export interface ReliefSpectrum {
  /** Where each is: f_x, f_y and the deviation of its light from there, 1/µm. */
  places: readonly (readonly [number, number, number])[]
  power: CellPower
}

/** @param relief - a map with the arrays `places` and `powers` */
export function reliefSpectrum(relief: LoadedMap): ReliefSpectrum {
  const placesArray = arrayOf(relief, 'places')
  const [cells, channels] = placesArray.spec.shape as [number, number]
  const numbers = valuesOf(placesArray)
  const array = arrayOf(relief, 'powers')
  const axis = array.spec.axes[1]!
  const values = valuesOf(array)
  return {
    places: Array.from({ length: cells }, (_, cell) => {
      const at = cell * channels
      return [numbers[at]!, numbers[at + 1]!, numbers[at + 2]!] as const
    }),
    power: (cell, p) => {
      const texel = Math.min(texelFromParameter(axis, p), axis.size - 1)
      const low = Math.min(Math.floor(texel), axis.size - 2)
      const at = cell * axis.size + low
      return values[at]! + (values[at + 1]! - values[at]!) * (texel - low)
    },
  }
}
