/**
 * Φ(x), the standard normal distribution: ½ + φ(x) (x + x³/3 + x⁵/(3·5) + …), to some 1e-15.
 *
 * Source: Marsaglia 2004, "Evaluating the normal distribution".
 */
export function normalCdf(x: number): number {
  // Beyond, what is left is below the last digit of 1.
  if (x < -8.3) return 0
  if (x > 8.3) return 1
  let term = x
  let sum = x
  for (let n = 3, before = NaN; sum !== before; n += 2) {
    before = sum
    term *= (x * x) / n
    sum += term
  }
  return 0.5 + sum * Math.exp(-0.5 * x * x - 0.5 * Math.log(2 * Math.PI))
}
