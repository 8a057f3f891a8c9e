import { LinearMipmapLinearFilter, Vector3, type DataArrayTexture } from 'three'
import type { Steps } from '../steps.ts'
import { averagedLayers } from './averaged-layers.ts'
import type { FoilGratings } from './foil-gratings.ts'

/** A bit of 32 for each grating tells the shader which ones a pixel shows. */
export const MOST_GRATINGS = 32

/** Gratings that follow a half angle, so that the share of each can be averaged where their orientations cannot. */
export interface FoilShares {
  /** cos θ, sin θ and frequency (1/µm) of each. */
  gratings: readonly Vector3[]
  /** Layer l, channel c, at each texel: the strength of grating 4 l + c there, 0 where another one is. */
  texture: DataArrayTexture
}

/** The shares of a foil of at most {@link MOST_GRATINGS} gratings. */
export function* foilShares({
  θ,
  frequency,
  width,
  height,
  ...at
}: FoilGratings): Steps<FoilShares> {
  const gratings = θ.map((angle, i) => new Vector3(Math.cos(angle), Math.sin(angle), frequency[i]))
  const layers = Math.ceil(gratings.length / 4)
  const texels = new Uint8Array(4 * layers * width * height)
  for (let texel = 0; texel < at.numberAt.length; texel++) {
    if (texel % width === 0) yield
    const number = at.numberAt[texel]!
    if (number < 0) continue
    const place = Math.floor(number / 4) * height * width + texel
    texels[4 * place + (number % 4)] = Math.round(255 * at.strengthAt[texel]!)
  }
  return {
    gratings,
    texture: averagedLayers(texels, width, height, layers, LinearMipmapLinearFilter),
  }
}
