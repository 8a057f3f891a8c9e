import { radicalInverse } from './radical-inverse.ts'

/** Steps of the lattice over the number of frames: powers of the inverse of the plastic number, 1.3247, the root of x³ = x + 1. */
const STEPS = [0.7548777, 0.5698403] as const

/**
 * Where each of so many frames has its pixels' centres, in pixels from their middles, −0.5 to 0.5. With the place of a frame
 * among the others' wavelengths they are a lattice in three dimensions: each offset along an axis comes once, their mean
 * is the middle, and none goes along with the wavelengths.
 *
 * @param frames - a power of 2; the first is next to the middle
 */
export function pixelOffsets(frames: number): [number, number][] {
  return Array.from({ length: frames }, (_, frame) => {
    const place = radicalInverse(frame) * frames
    const offset = (share: number): number => {
      // Odd, so that its multiples visit all.
      const step = 2 * Math.round((share * frames - 1) / 2) + 1
      const visited = (place * step + Math.floor(frames / 2)) % frames
      return (visited + 0.5) / frames - 0.5
    }
    return [offset(STEPS[0]), offset(STEPS[1])]
  })
}
