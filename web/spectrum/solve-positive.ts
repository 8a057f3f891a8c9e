/**
 * Solves A X = B for a symmetric, positive definite A: by elimination, which then needs no pivots and, A staying symmetric, no
 * more than what is right of the diagonal.
 *
 * @param rows - of A, of which what is left of the diagonal is not read; they are changed
 * @param columns - of B; those of X take their place
 */
export function solvePositive(
  rows: readonly Float64Array[],
  columns: readonly Float64Array[],
): void {
  const factor = (k: number, i: number): number => rows[k]![i]! / rows[k]![k]!
  rows.forEach((row, i) => {
    let k = 0
    // By pairs, so that the row is read and written half as often.
    for (; k < i - 1; k += 2)
      subtract(row, i, rows[k]!, factor(k, i), rows[k + 1]!, factor(k + 1, i))
    if (k < i) subtract(row, i, rows[k]!, factor(k, i), row, 0)
  })
  for (const column of columns) {
    rows.forEach((row, k) => {
      column[k]! /= row[k]!
      subtract(column, k + 1, row, column[k]!, row, 0)
    })
    for (let k = rows.length - 1; k >= 0; k--)
      column[k]! -= product(rows[k]!, column, k + 1) / rows[k]![k]!
  }
}

/** Takes so many times two others from a row, from some place on. */
function subtract(
  row: Float64Array,
  from: number,
  one: Float64Array,
  ones: number,
  other: Float64Array,
  others: number,
): void {
  for (let j = from; j < row.length; j++) row[j]! -= ones * one[j]! + others * other[j]!
}

/** The sum of the products of two rows' numbers, from some place on. */
export function product(one: Float64Array, other: Float64Array, from = 0): number {
  let sum = 0
  for (let j = from; j < one.length; j++) sum += one[j]! * other[j]!
  return sum
}
