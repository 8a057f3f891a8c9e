import { describe, expect, it } from 'vitest'
import { pickPlaces } from '../../demo/compare/places'
import { errorsOf } from '../../demo/compare/view-error'
import type { Sample } from '../../demo/compare/view-samples'
import { atOnce, type Steps } from '../../web/steps'

type Colour = [number, number, number]

const [WIDTH, HEIGHT] = [200, 100]
const never = (): boolean => false

const isHighlight = (pixel: number): boolean => pixel % 499 === 0
/** The left quarter shows no object. */
const isCovered = (pixel: number): boolean => pixel % WIDTH >= WIDTH / 4

/** As a foil under a lamp: dim, with a few highlights that have half of all. */
const truthAt = (pixel: number): Colour => {
  const value = isHighlight(pixel) ? 3 + Math.cos(pixel) : 0.14 + 0.03 * Math.sin(pixel)
  return [value, value / 2, 0]
}

/** One way is off where it is bright, the other where it is dim. */
const drawnAt = (pixel: number): Colour[] => {
  const factors = isHighlight(pixel) ? [1.1 + 0.05 * Math.sin(3 * pixel), 1.01] : [1.01, 0.7]
  return factors.map((factor) => truthAt(pixel).map((value) => value * factor) as Colour)
}

const pixels = Array.from({ length: WIDTH * HEIGHT }, (_, i) => i)

/** The view by each way. */
const pictures = [0, 1].map((way) => ({
  ...{ width: WIDTH, height: HEIGHT },
  pixels: Float32Array.from(
    pixels.flatMap((i) => (isCovered(i) ? [...drawnAt(i)[way]!, 1] : [9, 9, 9, 0])),
  ),
}))

const pixelOf = ({ x, y }: { x: number; y: number }): number =>
  Math.floor(((1 + y) / 2) * HEIGHT) * WIDTH + Math.floor(((1 + x) / 2) * WIDTH)

const places = pickPlaces(pictures)
const samples: Sample[] = places.map((place) => ({ ...place, colours: drawnAt(pixelOf(place)) }))
const truth = (sample: Sample): Colour => truthAt(pixelOf(sample))

/** A spectrum is summed up in steps. */
const inSteps = (colour: (sample: Sample) => Colour | null) =>
  function* (sample: Sample): Steps<Colour | null> {
    yield
    return colour(sample)
  }

/** The error of all that the object covers. */
const whole = [0, 1].map((way) => {
  const sum = (term: (pixel: number) => number): number =>
    pixels.filter(isCovered).reduce((total, pixel) => total + term(pixel) ** 2, 0)
  return Math.sqrt(
    sum((pixel) => drawnAt(pixel)[way]![0] - truthAt(pixel)[0]) / sum((pixel) => truthAt(pixel)[0]),
  )
})

describe('places of a view', () => {
  it('are few, and on the object', () => {
    expect(places.length).toBeLessThan(pixels.length / 100)
    expect(places.map(pixelOf).every(isCovered)).toBe(true)
  })

  it('are spread over the view, half of them too', () => {
    const [a, b] = [places.slice(0, places.length / 2), places.slice(places.length / 2)]
    const mean = (some: typeof places): number =>
      some.reduce((sum, { y }) => sum + y, 0) / some.length
    expect(Math.abs(mean(a) - mean(b))).toBeLessThan(0.1)
  })

  it('are none where all is dark', () => {
    const dark = pictures.map((picture) => ({
      ...picture,
      pixels: picture.pixels.map((value, i) => (i % 4 === 3 ? value : 0)),
    }))
    expect(pickPlaces(dark)).toEqual([])
  })
})

describe('the error at places', () => {
  it('is that of the view', () => {
    const found = atOnce(errorsOf(samples, inSteps(truth), never))!
    expect(Math.abs(found[0]! / whole[0]! - 1)).toBeLessThan(0.1)
    expect(Math.abs(found[1]! / whole[1]! - 1)).toBeLessThan(0.1)
  })

  it('leaves out what does not count', () => {
    const bright = (sample: Sample): Colour | null =>
      isHighlight(pixelOf(sample)) ? truth(sample) : null
    expect(atOnce(errorsOf(samples, inSteps(bright), never))![1]).toBeCloseTo(0.01, 6)
  })

  it('is none where hardly anything counts, or once the picture has changed', () => {
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
})
