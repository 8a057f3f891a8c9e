import { DataUtils } from 'three'
import { texelFromParameter } from '../maps/axes.ts'
import { arrayOf, type LoadedMap } from '../maps/load.ts'
import { METALS, type Metal } from '../surfaces/surface.ts'

/** R(λ) of a metal from its table, linear between texels; λ in µm. */
export function metalReflectance(metals: LoadedMap, metal: Metal): (wavelength: number) => number {
  const { spec, data } = arrayOf(metals, 'reflectance')
  const axis = spec.axes[1]!
  const channel = METALS.indexOf(metal)
  const at = (texel: number): number =>
    DataUtils.fromHalfFloat(data[texel * METALS.length + channel]!)
  return (wavelength) => {
    const texel = Math.min(Math.max(texelFromParameter(axis, 1 / wavelength), 0), axis.size - 1)
    const low = Math.min(Math.floor(texel), axis.size - 2)
    return at(low) + (at(low + 1) - at(low)) * (texel - low)
  }
}
