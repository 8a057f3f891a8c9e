const SIGN = 0x8000

/**
 * Sets negative half floats to zero, in texels of four channels: light cannot be negative, and blurring would spread
 * the hole.
 *
 * @returns the number of texels that had any
 */
export function clampNegative(halves: Uint16Array): number {
  let count = 0
  for (let texel = 0; texel < halves.length; texel += 4) {
    let isNegative = false
    for (let channel = texel; channel < texel + 4; channel++) {
      // The sign alone is −0, which is not below zero.
      if (halves[channel]! <= SIGN) continue
      halves[channel] = 0
      isNegative = true
    }
    if (isNegative) count++
  }
  return count
}
