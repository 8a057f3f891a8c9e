import {
  DataTexture,
  FloatType,
  HalfFloatType,
  LinearFilter,
  LinearMipmapLinearFilter,
  RepeatWrapping,
  RGBAFormat,
  UnsignedByteType,
  type TextureDataType,
} from 'three'
import { arrayOf, type LoadedMap, type MapArray } from './load.ts'
import { sharedTexture, unfiltered } from './shared-texture.ts'
import type { Dtype } from './sidecar.ts'

const TYPES: Record<Dtype, TextureDataType> = {
  float16: HalfFloatType,
  float32: FloatType,
  uint8: UnsignedByteType,
}

/**
 * An image of the surface, of four channels, as a texture that repeats, v upwards. Nearest texel: between two dots of a
 * foil lies neither's orientation, and the mean of two orientations is a third that is not there.
 */
export function imageTexture(map: LoadedMap, name: string): DataTexture {
  return sharedTexture(map, name, () => unfiltered(imageOf(map, name)))
}

/** Likewise of what has a mean, such as slopes: blended between texels, and mipmapped. */
export function smoothImageTexture(map: LoadedMap, name: string): DataTexture {
  return sharedTexture(map, name, () => {
    const texture = imageOf(map, name)
    texture.magFilter = LinearFilter
    texture.minFilter = LinearMipmapLinearFilter
    texture.generateMipmaps = true
    texture.needsUpdate = true
    return texture
  })
}

function imageOf(map: LoadedMap, name: string): DataTexture {
  const { spec, data } = arrayOf(map, name)
  const [height, width] = spec.shape
  const texture = new DataTexture(flipRows(data, height!), width, height, RGBAFormat)
  texture.type = TYPES[spec.dtype]
  texture.wrapS = texture.wrapT = RepeatWrapping
  return texture
}

function flipRows(data: MapArray['data'], rows: number): MapArray['data'] {
  const stride = data.length / rows
  const flipped = data.slice()
  for (let row = 0; row < rows; row++)
    flipped.set(data.subarray(row * stride, (row + 1) * stride), (rows - 1 - row) * stride)
  return flipped
}
