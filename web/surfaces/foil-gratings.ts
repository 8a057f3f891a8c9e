import { refuse } from '../errors.ts'
import { arrayOf, valuesOf, type LoadedMap } from '../maps/load.ts'
import type { Steps } from '../steps.ts'

/** As many as channels of 8 bits can hold: the unit circle passes 1020 of their cells, at each of 256 frequencies. */
const MOST_DIFFERENT = 2 ** 18

/** The different gratings of a foil's map, and which of them lies where. */
export interface FoilGratings {
  /** Orientation from −π/2 to π/2, rad, of each grating. */
  θ: readonly number[]
  /** 1/period of each, 1/µm. */
  frequency: readonly number[]
  /** Texels along u and v. */
  width: number
  height: number
  /** Number of the grating at each texel, rows from the bottom as v grows; −1 where nothing diffracts. */
  numberAt: Int32Array
  /** Share of each texel that diffracts, 0 to 1, rows likewise. */
  strengthAt: Float32Array
  /** Whether all of every texel diffracts. */
  isWhole: boolean
}

/** Row by row. Throws a DiffractionError where there are more than can be put in clusters in a few seconds. */
export function* foilGratings(map: LoadedMap): Steps<FoilGratings> {
  const { spec, data } = arrayOf(map, 'grating')
  const [height, width] = spec.shape as [number, number]
  const numbers = new Map<string, number>()
  const θ: number[] = []
  const frequency: number[] = []
  const numberAt = new Int32Array(width * height).fill(-1)
  const strengthAt = new Float32Array(width * height)
  for (let row = 0; row < height; row++) {
    const values = valuesOf({ spec, data: data.subarray(4 * width * row, 4 * width * (row + 1)) })
    const start = (height - 1 - row) * width
    for (let column = 0; column < width; column++) {
      const cos2 = values[4 * column]!
      const sin2 = values[4 * column + 1]!
      const grooves = values[4 * column + 2]!
      const strength = values[4 * column + 3]!
      if (!(strength > 0 && grooves > 0)) continue
      const key = `${cos2},${sin2},${grooves}`
      let number = numbers.get(key)
      if (number === undefined) {
        numbers.set(key, (number = θ.length))
        if (number === MOST_DIFFERENT)
          refuse(
            `${map.url}.json`,
            'arrays.grating',
            'more',
            `${MOST_DIFFERENT} different gratings at most`,
          )
        θ.push(Math.atan2(sin2, cos2) / 2)
        frequency.push(grooves)
      }
      numberAt[start + column] = number
      strengthAt[start + column] = strength
    }
    yield
  }
  const isWhole = strengthAt.every((strength) => strength >= 1)
  return { θ, frequency, width, height, numberAt, strengthAt, isWhole }
}
