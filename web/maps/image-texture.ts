import {
  DataTexture,
  FloatType,
  HalfFloatType,
  NearestFilter,
  RepeatWrapping,
  RGBAFormat,
  UnsignedByteType,
  type TextureDataType,
} from 'three'
import { arrayOf, type LoadedMap, type MapArray } from './load'
import type { Dtype } from './sidecar'

const TYPES: Record<Dtype, TextureDataType> = {
  float16: HalfFloatType,
  float32: FloatType,
  uint8: UnsignedByteType,
}

const made = new WeakMap<MapArray, DataTexture>()

/**
 * An image of the surface, of four channels, as a texture that repeats, v upwards. Nearest texel: between two dots of a
 * foil lies neither's orientation, and the mean of two orientations is a third that is not there. Made once an array.
 */
export function imageTexture(map: LoadedMap, name: string): DataTexture {
  const array = arrayOf(map, name)
  const known = made.get(array)
  if (known !== undefined) return known
  const [height, width] = array.spec.shape
  const texture = new DataTexture(flipRows(array.data, height!), width, height, RGBAFormat)
  texture.type = TYPES[array.spec.dtype]
  texture.wrapS = texture.wrapT = RepeatWrapping
  texture.minFilter = texture.magFilter = NearestFilter
  texture.needsUpdate = true
  made.set(array, texture)
  return texture
}

function flipRows(data: MapArray['data'], rows: number): MapArray['data'] {
  const stride = data.length / rows
  const flipped = data.slice()
  for (let row = 0; row < rows; row++)
    flipped.set(data.subarray(row * stride, (row + 1) * stride), (rows - 1 - row) * stride)
  return flipped
}
