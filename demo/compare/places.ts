import type { RadiancePicture } from './radiance-picture'

/** How many are picked, and in which steps they are gone through: any first part of them is spread over the view. */
const COUNT = 144
const STEP = 55

/** A place of the view, and how likely it was to be picked. */
export interface Place {
  /** Across and up, −1 to 1. */
  x: number
  y: number
  /** In any unit. */
  share: number
}

/** Fractions of the powers of the plastic number: places that fill a square evenly, however many there are (Roberts 2018). */
const EVEN = [0.7548776662466927, 0.5698402909980532] as const

/**
 * Places that an object covers: half of them even, half by the square of radiance, as that of an error goes with it. They
 * are the same each time, in an order that is spread over the view.
 *
 * @param pictures - of the view, of one size
 */
export function pickPlaces(pictures: readonly RadiancePicture[]): Place[] {
  const { width, height, pixels } = pictures[0]!
  const squares = Float64Array.from({ length: width * height }, (_, i) =>
    pictures.reduce((sum, { pixels }) => {
      const [r, g, b] = pixels.subarray(4 * i)
      return sum + r! ** 2 + g! ** 2 + b! ** 2
    }, 0),
  )
  const isCovered = (i: number): boolean => pixels[4 * i + 3]! > 0
  const covered = Array.from(squares.keys()).filter(isCovered)
  const whole = covered.reduce((sum, i) => sum + squares[i]!, 0)
  if (whole === 0) return []
  const picked: Place[] = []
  let sum = 0
  for (const i of covered) {
    const share = 0.5 / covered.length + (0.5 * squares[i]!) / whole
    sum += share
    while (picked.length < COUNT && (picked.length + 0.5) / COUNT < sum) {
      const [dx, dy] = EVEN.map((step) => (0.5 + picked.length * step) % 1) as [number, number]
      picked.push({
        x: (2 * ((i % width) + dx)) / width - 1,
        y: (2 * (Math.floor(i / width) + dy)) / height - 1,
        share,
      })
    }
  }
  return picked.map((_, i) => picked[(i * STEP) % picked.length]!)
}
