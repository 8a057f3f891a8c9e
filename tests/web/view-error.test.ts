import { expect, it, vi } from 'vitest'
import { errorsOf } from '../../demo/compare/view-error'
import type { Colour } from '../../demo/inspector/optics/light-spectrum'
import type { Sample } from '../../demo/compare/view-strips'
import { atOnce, type Steps } from '../../web/steps'

const never = (): boolean => false

/** As a foil under a lamp: dim, with a few highlights that have half of all. */
const truth = ({ x }: Sample): Colour => {
  const value = x % 500 === 0 ? 3 + Math.cos(x) : 0.14 + 0.03 * Math.sin(x)
  return [value, value / 2, 0]
}

/** One way is off where it is bright, the other where it is dim. */
const factors = (place: number): [number, number] =>
  place % 500 === 0 ? [1.1 + 0.05 * Math.sin(3 * place), 1.01] : [1.01, 0.7]

const samples: Sample[] = Array.from({ length: 20_000 }, (_, x) => ({
  ...{ x, y: 0 },
  colours: factors(x).map((factor) => truth({ x, y: 0, colours: [] }).map((c) => c * factor)),
}))

/** The error of all samples. */
const whole = [0, 1].map((way) => {
  const sum = (term: (sample: Sample) => number): number =>
    samples.reduce((total, sample) => total + term(sample) ** 2, 0)
  const off = (sample: Sample): number => sample.colours[way]![0]! - truth(sample)[0]
  return Math.sqrt(sum(off) / sum((sample) => truth(sample)[0]))
})

/** A spectrum is summed up in steps. */
const inSteps = (colour: (sample: Sample) => Colour | null) =>
  function* (sample: Sample): Steps<Colour | null> {
    yield
    return colour(sample)
  }

it('finds the errors of a view from a hundredth of its places', () => {
  const sums = vi.fn(truth)
  const found = atOnce(errorsOf(samples, inSteps(sums), never))!
  expect(Math.abs(found[0]! / whole[0]! - 1)).toBeLessThan(0.1)
  expect(Math.abs(found[1]! / whole[1]! - 1)).toBeLessThan(0.1)
  expect(sums.mock.calls.length).toBeLessThan(samples.length / 100)
})

it('leaves out what does not count', () => {
  const bright = (sample: Sample): Colour | null => (sample.x % 500 === 0 ? truth(sample) : null)
  const found = atOnce(errorsOf(samples, inSteps(bright), never))!
  expect(found[1]).toBeCloseTo(0.01, 6)
})

it('finds none where it is dark, where hardly anything counts, or once the picture has changed', () => {
  const dark = samples.map((sample) => ({ ...sample, colours: [[0, 0, 0]] }))
  expect(atOnce(errorsOf(dark, inSteps(truth), never))).toBeNull()
  expect(
    atOnce(
      errorsOf(
        samples,
        inSteps(() => null),
        never,
      ),
    ),
  ).toBeNull()
  expect(atOnce(errorsOf(samples, inSteps(truth), () => true))).toBeNull()
})
