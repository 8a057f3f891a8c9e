import { DataTexture, DataUtils, HalfFloatType, RGBAFormat } from 'three'
import type { LoadedMap } from '../maps/load.ts'
import { filtered, sharedTexture } from '../maps/shared-texture.ts'
import { metalReflectance } from '../spectrum/metal-reflectance.ts'
import { spectralNodes } from '../spectrum/spectral-nodes.ts'
import type { Metal } from '../surfaces/surface.ts'
import { environmentSamples, W_STEPS, type EnvironmentSample } from './environment-samples.ts'

/** Lookups of the environment for each of a material's nodes. */
const LOOKUPS_PER_NODE = 16

/** What every WebGL 2 can hold along one side of a texture. */
const MAX_LOOKUPS = 2048

/** Lookups at most: fewer where a relief has fewer lines. */
export function lookups(environmentNodes: number): number {
  return Math.min(LOOKUPS_PER_NODE * environmentNodes, MAX_LOOKUPS)
}

/** Bands of the spectrum that samples are put together from. */
const BANDS = 32

/**
 * The samples of shaders/environment-samples.glsl, a row each: colours over w in light of the red, green and blue basis side by side,
 * then a texel of middle (x, y) and deviation. Made once for all materials that agree on the arguments.
 *
 * @param metal - null: a perfect mirror
 */
export function environmentTexture(
  relief: LoadedMap,
  lobes: LoadedMap,
  metals: LoadedMap,
  metal: Metal | null,
  environmentNodes: number,
): DataTexture {
  const count = lookups(environmentNodes)
  return sharedTexture(relief, `samples ${lobes.url} ${metal ?? 'mirror'} ${count}`, () => {
    const reflectance = metal === null ? () => 1 : metalReflectance(metals, metal)
    const nodes = spectralNodes(lobes, BANDS, 'weighted').map((node) => ({
      ...node,
      tints: node.tints.map((value) => value * reflectance(node.wavelength)),
    }))
    return samplesTexture(environmentSamples(relief, nodes, count))
  })
}

function samplesTexture(samples: readonly EnvironmentSample[]): DataTexture {
  const width = 3 * W_STEPS + 1
  const texels = new Uint16Array(4 * width * samples.length)
  const put = (row: number, column: number, channel: number, value: number): void => {
    texels[4 * (row * width + column) + channel] = DataUtils.toHalfFloat(value)
  }
  samples.forEach(({ place, deviation, colors }, row) => {
    colors.forEach((value, i) => {
      const tint = Math.floor((i % 9) / 3)
      put(row, tint * W_STEPS + Math.floor(i / 9), i % 3, value)
    })
    ;[...place, deviation].forEach((value, channel) => {
      put(row, width - 1, channel, value)
    })
  })
  return filtered(new DataTexture(texels, width, samples.length, RGBAFormat, HalfFloatType))
}
