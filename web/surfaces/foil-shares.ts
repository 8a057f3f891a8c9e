import {
  DataArrayTexture,
  LinearFilter,
  LinearMipmapLinearFilter,
  RepeatWrapping,
  RGBAFormat,
  Vector3,
} from 'three'
import { arrayOf, valuesOf, type LoadedMap } from '../maps/load'
import { sharedTexture } from '../maps/shared-texture'

/** A bit of 32 for each grating tells the shader which ones a pixel shows. */
export const MOST_GRATINGS = 32

/** Gratings that follow a half angle, so that the share of each can be averaged where their orientations cannot. */
export interface FoilShares {
  /** cos θ, sin θ and frequency (1/µm) of each grating that occurs on the foil. */
  gratings: readonly Vector3[]
  /** Layer l, channel c, at each texel: the strength of grating 4 l + c there, 0 where another one is. */
  texture: DataArrayTexture
}

/** The gratings of a foil and where each lies; null where there are none, or more than {@link MOST_GRATINGS}. */
export function foilShares(map: LoadedMap): FoilShares | null {
  const array = arrayOf(map, 'grating')
  const [height, width] = array.spec.shape as [number, number]
  const values = valuesOf(array)
  const numbers = new Map<string, number>()
  const gratings: Vector3[] = []
  const numberAt = new Int32Array(width * height).fill(-1)
  for (let texel = 0; texel < numberAt.length; texel++) {
    const [cos2, sin2, frequency, strength] = values.subarray(4 * texel, 4 * texel + 4)
    if (!(strength! > 0 && frequency! > 0)) continue
    const key = `${cos2!},${sin2!},${frequency!}`
    let number = numbers.get(key)
    if (number === undefined) {
      if (gratings.length === MOST_GRATINGS) return null
      numbers.set(key, (number = gratings.length))
      const θ = Math.atan2(sin2!, cos2!) / 2
      gratings.push(new Vector3(Math.cos(θ), Math.sin(θ), frequency))
    }
    numberAt[texel] = number
  }
  if (gratings.length === 0) return null
  const texture = sharedTexture(map, 'grating shares', () => {
    const layers = Math.ceil(gratings.length / 4)
    const texels = new Uint8Array(4 * layers * width * height)
    numberAt.forEach((number, texel) => {
      if (number < 0) return
      // Rows from the bottom, as v grows.
      const row = height - 1 - Math.floor(texel / width)
      const at = (Math.floor(number / 4) * height + row) * width + (texel % width)
      texels[4 * at + (number % 4)] = Math.round(255 * values[4 * texel + 3]!)
    })
    const made = new DataArrayTexture(texels, width, height, layers)
    made.format = RGBAFormat
    made.wrapS = made.wrapT = RepeatWrapping
    made.magFilter = LinearFilter
    made.minFilter = LinearMipmapLinearFilter
    made.generateMipmaps = true
    made.needsUpdate = true
    return made
  })
  return { gratings, texture }
}
