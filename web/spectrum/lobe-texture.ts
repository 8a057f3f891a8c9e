import { DataTexture, DataUtils, HalfFloatType, RGBAFormat } from 'three'
import { arrayOf, type LoadedMap } from '../maps/load.ts'
import { filtered } from '../maps/shared-texture.ts'

/**
 * The colours of lobes as seen in a metal: each texel's XYZ times R at that texel's own mean wavenumber, over which a
 * metal's reflectance hardly varies. So the shader is spared a lookup for every order.
 *
 * @param lobes - a map of kind 'lobes'
 * @param reflectance - R(λ), λ in µm
 */
export function lobeTexture(
  lobes: LoadedMap,
  reflectance: (wavelength: number) => number,
): DataTexture {
  const { spec, data } = arrayOf(lobes, 'lobe')
  const [layers, height, width] = spec.shape
  const seen = new Uint16Array(data)
  for (let i = 0; i < seen.length; i += 4) {
    const r = reflectance(1 / DataUtils.fromHalfFloat(seen[i + 3]!))
    for (let c = i; c < i + 3; c++)
      seen[c] = DataUtils.toHalfFloat(DataUtils.fromHalfFloat(seen[c]!) * r)
  }
  // The layers as one picture, one above the other: a plain texture is cheaper to read than an array of them.
  return filtered(new DataTexture(seen, width, layers! * height!, RGBAFormat, HalfFloatType))
}
