/** Largest finite half float. */
const LARGEST_HALF = 0x7bff
const HALF_INFINITY = 0x7c00
const SIGN = 0x8000

/**
 * Texels of an environment without what light cannot be: negative and NaN channels become 0, infinite ones the largest
 * half float. Published environments hold such texels; averaged into a mip level or between neighbours they would
 * darken or destroy what is around them.
 *
 * @param data - half floats (Uint16Array) or floats
 * @returns the array itself where nothing was wrong, else a copy; and how many channels were changed
 */
export function lightTexels<T extends Uint16Array | Float32Array>(
  data: T,
): { data: T; changed: number } {
  const repaired = data instanceof Float32Array ? repairedFloat : repairedHalf
  let copy: T | null = null
  let changed = 0
  for (let i = 0; i < data.length; i++) {
    const value = data[i]!
    const light = repaired(value)
    if (Object.is(light, value)) continue
    copy ??= data.slice() as T
    copy[i] = light
    changed++
  }
  return { data: copy ?? data, changed }
}

function repairedFloat(value: number): number {
  if (value === Infinity) return 65504
  return value >= 0 ? value : 0
}

function repairedHalf(bits: number): number {
  if ((bits & HALF_INFINITY) === HALF_INFINITY) return bits === HALF_INFINITY ? LARGEST_HALF : 0
  return bits > SIGN ? 0 : bits
}
