/**
 * The binary digits of i mirrored at the point (van der Corput 1935): numbers from 0 to 1, 1 excluded, of which the first 2,
 * 4, 8 … are even steps.
 *
 * @param i - 0, 1, 2 …
 */
export function radicalInverse(i: number): number {
  let value = 0
  for (let digits = i, place = 0.5; digits > 0; digits = Math.floor(digits / 2), place /= 2)
    value += (digits % 2) * place
  return value
}
