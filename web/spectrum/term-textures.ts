import {
  DataArrayTexture,
  DataTexture,
  FloatType,
  HalfFloatType,
  NearestFilter,
  RGBAFormat,
} from 'three'
import { arrayOf, valuesOf, type LoadedMap } from '../maps/load'

interface TermTextures {
  terms: DataArrayTexture
  coefficients: DataTexture
}

const made = new WeakMap<LoadedMap, TermTextures>()

/** What shaders/expansion.glsl reads. Made once a map. terms: a map of kind 'height-field-terms'. */
export function termTextures(map: LoadedMap): TermTextures {
  let textures = made.get(map)
  if (textures === undefined)
    made.set(map, (textures = { terms: termsTexture(map), coefficients: coefficientsTexture(map) }))
  return textures
}

/** The spectra, a layer for each pair of terms. */
function termsTexture(map: LoadedMap): DataArrayTexture {
  const { spec, data } = arrayOf(map, 'terms')
  const [layers, height, width] = spec.shape
  const texture = new DataArrayTexture(data, width, height, layers)
  texture.format = RGBAFormat
  texture.type = spec.dtype === 'float16' ? HalfFloatType : FloatType
  texture.minFilter = texture.magFilter = NearestFilter
  texture.needsUpdate = true
  return texture
}

/**
 * The coefficients of a pair of terms a row: a texel holds c and its step to the next argument, of the even term and
 * of the odd one, so that a linear lookup of both is one fetch.
 */
function coefficientsTexture(map: LoadedMap): DataTexture {
  const array = arrayOf(map, 'coefficients')
  const [terms, samples] = array.spec.shape as [number, number]
  const values = valuesOf(array)
  const pairs = Math.ceil(terms / 2)
  const texels = new Float32Array(4 * pairs * samples)
  for (let n = 0; n < terms; n++) {
    const row = values.subarray(n * samples, (n + 1) * samples)
    row.forEach((value, i) => {
      const texel = 4 * ((n >> 1) * samples + i) + 2 * (n % 2)
      texels[texel] = value
      texels[texel + 1] = (row[i + 1] ?? value) - value
    })
  }
  const texture = new DataTexture(texels, samples, pairs, RGBAFormat, FloatType)
  texture.minFilter = texture.magFilter = NearestFilter
  texture.needsUpdate = true
  return texture
}
