import { DataTexture, FloatType, NearestFilter, RGFormat } from 'three'
import { arrayOf, valuesOf, type LoadedMap, type MapArray } from '../maps/load'

const made = new WeakMap<MapArray, DataTexture>()

/**
 * The efficiencies of a profile, phase along x, order along y: a texel holds η and its step to the next phase, so that
 * a linear lookup reads one texel where a filtered texture reads four. Made once a profile.
 *
 * @param profile - a map of kind 'profile'
 */
export function efficiencyTexture(profile: LoadedMap): DataTexture {
  const array = arrayOf(profile, 'efficiency')
  const known = made.get(array)
  if (known !== undefined) return known
  const [height, width] = array.spec.shape
  const efficiencies = valuesOf(array)
  const texels = new Float32Array(2 * efficiencies.length)
  efficiencies.forEach((efficiency, i) => {
    const isLast = i % width! === width! - 1
    texels[2 * i] = efficiency
    texels[2 * i + 1] = isLast ? 0 : efficiencies[i + 1]! - efficiency
  })
  const texture = new DataTexture(texels, width, height, RGFormat, FloatType)
  texture.minFilter = texture.magFilter = NearestFilter
  texture.needsUpdate = true
  made.set(array, texture)
  return texture
}
