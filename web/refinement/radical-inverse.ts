/**
 * The digits of i mirrored at the point (van der Corput 1935): numbers from 0 to 1, 1 excluded, that fill it evenly
 * however many are taken.
 *
 * @param i - 0, 1, 2 …
 * @param base - of the digits, 2 or more
 */
export function radicalInverse(i: number, base: number): number {
  let value = 0
  for (
    let digits = i, place = 1 / base;
    digits > 0;
    digits = Math.floor(digits / base), place /= base
  )
    value += (digits % base) * place
  return value
}
