import { DataUtils } from 'three'
import { luminance } from '../numbers/luminance'

/** Mean luminance over the sphere of an equirectangular image, linear sRGB in half floats, four channels. */
export function meanLuminance(halves: Uint16Array, width: number, height: number): number {
  const at = (index: number): number => DataUtils.fromHalfFloat(halves[index]!)
  let sum = 0
  let total = 0
  for (let row = 0; row < height; row++) {
    // Rows near the poles stand for less solid angle.
    const weight = Math.sin((Math.PI * (row + 0.5)) / height)
    for (let column = 0; column < width; column++) {
      const i = 4 * (row * width + column)
      sum += weight * luminance(at(i), at(i + 1), at(i + 2))
      total += weight
    }
  }
  return sum / total
}
