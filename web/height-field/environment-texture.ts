import { DataTexture, DataUtils, HalfFloatType, RGBAFormat } from 'three'
import { LazyCode } from '../lazy-code.ts'
import type { LoadedMap } from '../maps/load.ts'
import { filtered, sharedInSteps } from '../maps/shared-texture.ts'
import { metalReflectance } from '../spectrum/metal-reflectance.ts'
import { seenIn, spectralNodes } from '../spectrum/spectral-nodes.ts'
import type { Steps } from '../steps.ts'
import type { Metal } from '../surfaces/surface.ts'
import type { EnvironmentSample } from './environment-samples.ts'
import { lookups, W_STEPS } from './lookups.ts'
import { reliefSpectrum } from './relief-spectrum.ts'

export const samplesCode = new LazyCode(() => import('./environment-samples.ts'))

/** Bands of the spectrum that samples are put together from. */
const BANDS = 32

/**
 * The samples of shaders/environment-samples.glsl, a row each: colours over w in light of the red, green and blue basis side by side,
 * then a texel of middle (x, y) and deviation. Made once for all materials that agree on the arguments, when `samplesCode` has come.
 *
 * @param metal - null: a perfect mirror
 */
export function environmentTexture(
  relief: LoadedMap,
  lobes: LoadedMap,
  metals: LoadedMap,
  metal: Metal | null,
  environmentNodes: number,
): Steps<DataTexture> {
  const count = lookups(environmentNodes)
  const name = `samples ${lobes.url} ${metal ?? 'mirror'} ${count}`
  return sharedInSteps(relief, name, function* () {
    const reflectance = metal === null ? () => 1 : metalReflectance(metals, metal)
    const nodes = seenIn(spectralNodes(lobes, BANDS, 'weighted'), reflectance)
    const { environmentSamples } = samplesCode.code!
    return samplesTexture(yield* environmentSamples(reliefSpectrum(relief), nodes, count))
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
