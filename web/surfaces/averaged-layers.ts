import {
  DataArrayTexture,
  HalfFloatType,
  LinearFilter,
  RepeatWrapping,
  RGBAFormat,
  UnsignedByteType,
  type MinificationTextureFilter,
} from 'three'

/** A texture of four channels a layer, that repeats, and whose mip levels are means. Half floats as 16-bit words. */
export function averagedLayers(
  texels: Uint8Array<ArrayBuffer> | Uint16Array<ArrayBuffer>,
  width: number,
  height: number,
  layers: number,
  minFilter: MinificationTextureFilter,
): DataArrayTexture {
  const texture = new DataArrayTexture(texels, width, height, layers)
  texture.format = RGBAFormat
  texture.type = texels instanceof Uint16Array ? HalfFloatType : UnsignedByteType
  texture.wrapS = texture.wrapT = RepeatWrapping
  texture.magFilter = LinearFilter
  texture.minFilter = minFilter
  texture.generateMipmaps = true
  texture.needsUpdate = true
  return texture
}
