import { expect, it } from 'vitest'
import { gaussianTaps } from '../../web/environment/gaussian-taps'

it.each([9, 17])('blurs by a deviation of 1 with %i taps, and what each reads', (count) => {
  const { taps, width } = gaussianTaps(count, true)
  const moment = (power: number): number => taps.reduce((sum, { x, y }) => sum + y * x ** power, 0)
  expect(moment(0)).toBeCloseTo(1, 12)
  expect(moment(1)).toBeCloseTo(0, 12)
  // A lookup of that full width has half of it as its deviation.
  const own = (width / 2) ** 2
  expect(moment(2) + own).toBeCloseTo(1, 12)
})

it('blurs by a deviation of 1 where what each tap reads is not blurred', () => {
  const { taps } = gaussianTaps(7, false)
  expect(taps.reduce((sum, { y }) => sum + y, 0)).toBeCloseTo(1, 12)
  expect(taps.reduce((sum, { x, y }) => sum + y * x * x, 0)).toBeCloseTo(1, 12)
})

it('has the fourth moment of a Gaussian, 3, but for its tails', () => {
  const { taps } = gaussianTaps(17, true)
  const fourth = taps.reduce((sum, { x, y }) => sum + y * x ** 4, 0)
  expect(fourth).toBeGreaterThan(2.6)
  expect(fourth).toBeLessThan(3)
})
