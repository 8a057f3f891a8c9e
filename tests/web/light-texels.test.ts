import { DataUtils } from 'three'
import { describe, expect, it } from 'vitest'
import { lightTexels } from '../../web/environment/light-texels'

const values = [0, -0, 1.5, -149, NaN, Infinity, -Infinity, 65504]
const light = [0, 0, 1.5, 0, 0, 65504, 0, 65504]

describe('an environment as light', () => {
  it('loses what light cannot be, in floats', () => {
    const data = Float32Array.from(values)
    const { data: repaired, changed } = lightTexels(data)
    expect(Array.from(repaired, (v) => v + 0)).toEqual(light)
    expect(changed).toBe(4)
    expect(data[3]).toBe(-149)
  })

  it('loses what light cannot be, in half floats', () => {
    const halves = values.map((v) =>
      v === Infinity
        ? 0x7c00
        : v === -Infinity
          ? 0xfc00
          : Number.isNaN(v)
            ? 0x7e00
            : DataUtils.toHalfFloat(v),
    )
    const { data, changed } = lightTexels(Uint16Array.from(halves))
    expect(Array.from(data, (h) => DataUtils.fromHalfFloat(h) + 0)).toEqual(light)
    expect(changed).toBe(4)
  })

  it('is the same array where nothing is wrong', () => {
    const data = Float32Array.of(0, 1, 2)
    expect(lightTexels(data).data).toBe(data)
  })
})
