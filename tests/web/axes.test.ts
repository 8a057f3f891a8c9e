import { describe, expect, it } from 'vitest'
import {
  coordinateFromTexel,
  MAPPINGS,
  parameterFromTexel,
  texelFromCoordinate,
  texelFromParameter,
  type Axis,
} from '../../web/maps/axes'

const axis = (mapping: Axis['mapping']): Axis => ({
  name: 'phase',
  symbol: 'phi',
  unit: 'rad',
  size: 33,
  mapping,
  first: mapping === 'square' ? 0 : 0.25,
  last: 20,
})

describe.each(MAPPINGS)('%s axis', (mapping) => {
  it('puts its ends on the first and last texel', () => {
    expect(parameterFromTexel(axis(mapping), 0)).toBe(axis(mapping).first)
    expect(parameterFromTexel(axis(mapping), 32)).toBeCloseTo(20, 12)
  })

  it('comes back from texel to parameter to texel', () => {
    for (let texel = 0; texel <= 32; texel += 0.37) {
      const parameter = parameterFromTexel(axis(mapping), texel)
      expect(texelFromParameter(axis(mapping), parameter)).toBeCloseTo(texel, 10)
    }
  })
})

it('has the middle of each mapping where it is known', () => {
  expect(parameterFromTexel(axis('linear'), 16)).toBeCloseTo((0.25 + 20) / 2, 12)
  expect(parameterFromTexel(axis('square'), 16)).toBeCloseTo(20 / 4, 12)
  expect(parameterFromTexel(axis('log'), 16)).toBeCloseTo(Math.sqrt(0.25 * 20), 12)
})

it('puts texel centres half a texel inside the texture', () => {
  expect(coordinateFromTexel(axis('linear'), 0)).toBe(0.5 / 33)
  expect(coordinateFromTexel(axis('linear'), 32)).toBe(32.5 / 33)
  for (const texel of [0, 7.25, 32])
    expect(
      texelFromCoordinate(axis('linear'), coordinateFromTexel(axis('linear'), texel)),
    ).toBeCloseTo(texel, 12)
})

it('holds the one value of an axis of one texel', () => {
  const single = { ...axis('linear'), size: 1 }
  expect(parameterFromTexel(single, 0)).toBe(0.25)
  expect(texelFromParameter(single, 0.25)).toBe(0)
})
