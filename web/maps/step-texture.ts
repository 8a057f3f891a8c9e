import { DataTexture, FloatType, RGFormat } from 'three'
import { arrayOf, valuesOf, type LoadedMap } from './load.ts'
import { sharedTexture, unfiltered } from './shared-texture.ts'

/**
 * A table of two axes and one channel, the faster axis along x: a texel holds the value and its step to the next texel,
 * so that a lookup that is linear along x reads one texel where a filtered texture reads four.
 *
 * @param firstRow - rows before it are left out
 */
export function stepTexture(map: LoadedMap, name: string, firstRow = 0): DataTexture {
  return sharedTexture(map, `${name} from ${firstRow}`, () => {
    const array = arrayOf(map, name)
    const [rows, width] = array.spec.shape
    const values = valuesOf(array).subarray(firstRow * width!)
    const texels = new Float32Array(2 * values.length)
    values.forEach((value, i) => {
      const isLast = i % width! === width! - 1
      texels[2 * i] = value
      texels[2 * i + 1] = isLast ? 0 : values[i + 1]! - value
    })
    return unfiltered(new DataTexture(texels, width, rows! - firstRow, RGFormat, FloatType))
  })
}
