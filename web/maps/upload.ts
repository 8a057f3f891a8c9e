import {
  ClampToEdgeWrapping,
  DataTexture,
  FloatType,
  HalfFloatType,
  LinearFilter,
  NearestFilter,
  NoColorSpace,
  RedFormat,
  RepeatWrapping,
  RGBAFormat,
  UnsignedByteType,
  type PixelFormat,
  type TextureDataType,
} from 'three'
import { DiffractionError } from '../errors'
import { arrayOf, type LoadedMap, type MapArray } from './load'
import type { Dtype } from './sidecar'

const TYPES: Record<Dtype, TextureDataType> = {
  float16: HalfFloatType,
  float32: FloatType,
  uint8: UnsignedByteType,
}

const tables = new WeakMap<MapArray, DataTexture>()
const images = new WeakMap<MapArray, DataTexture>()

/** A table of two axes as a texture: the faster axis along x, linear between texels. Made once an array. */
export function tableTexture(map: LoadedMap, name: string): DataTexture {
  return once(tables, arrayOf(map, name), (array) => {
    const [height, width] = sizes(map, name, array, 3)
    const texture = new DataTexture(array.data, width, height, formatOf(map, name, array))
    return finish(texture, array)
  })
}

/**
 * An image of the surface as a texture that repeats, v upwards. Nearest texel: between two dots of a foil lies
 * neither's orientation, and the mean of two orientations is a third that is not there. Made once an array.
 */
export function imageTexture(map: LoadedMap, name: string): DataTexture {
  return once(images, arrayOf(map, name), (array) => {
    const [height, width] = sizes(map, name, array, 3)
    const texture = new DataTexture(
      flipRows(array.data, height!),
      width,
      height,
      formatOf(map, name, array),
    )
    finish(texture, array)
    texture.wrapS = texture.wrapT = RepeatWrapping
    texture.minFilter = texture.magFilter = NearestFilter
    return texture
  })
}

function once<T>(made: WeakMap<MapArray, T>, array: MapArray, make: (array: MapArray) => T): T {
  const known = made.get(array)
  if (known !== undefined) return known
  const texture = make(array)
  made.set(array, texture)
  return texture
}

function sizes(map: LoadedMap, name: string, { spec }: MapArray, rank: number): number[] {
  if (spec.shape.length === rank) return spec.shape
  throw new DiffractionError({
    file: `${map.url}.json`,
    field: `arrays.${name}.shape`,
    value: spec.shape,
    expected: `${rank} sizes`,
  })
}

function formatOf(map: LoadedMap, name: string, { spec }: MapArray): PixelFormat {
  const channels = spec.channels.length
  if (channels === 1) return RedFormat
  if (channels === 4) return RGBAFormat
  throw new DiffractionError({
    file: `${map.url}.json`,
    field: `arrays.${name}.channels`,
    value: spec.channels,
    expected: '1 or 4 channels, which is what a texture can hold',
  })
}

function finish(texture: DataTexture, { spec }: MapArray): DataTexture {
  texture.type = TYPES[spec.dtype]
  texture.colorSpace = NoColorSpace
  texture.minFilter = texture.magFilter = LinearFilter
  texture.wrapS = texture.wrapT = ClampToEdgeWrapping
  texture.generateMipmaps = false
  // A row of 16-bit single channels need not be a multiple of the default 4 bytes.
  texture.unpackAlignment = 1
  texture.needsUpdate = true
  return texture
}

function flipRows(data: MapArray['data'], rows: number): MapArray['data'] {
  const stride = data.length / rows
  const flipped = data.slice()
  for (let row = 0; row < rows; row++)
    flipped.set(data.subarray(row * stride, (row + 1) * stride), (rows - 1 - row) * stride)
  return flipped
}
