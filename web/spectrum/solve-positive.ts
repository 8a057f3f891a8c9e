/**
 * Solves A X = B for a symmetric, positive definite A by Cholesky's decomposition into L Lᵀ: a third of the operations of an
 * elimination of any matrix, and no pivots.
 *
 * @param matrix - rows of A, up to and with the diagonal at least; L takes their place
 * @param columns - of B, each as long as A has rows; those of X take their place
 */
export function solvePositive(
  matrix: readonly Float64Array[],
  columns: readonly Float64Array[],
): void {
  // L Y = B is solved by the sums that make rows of L: a column of B is one more row.
  ;[...matrix, ...columns].forEach((row, i) => {
    for (let j = 0; j <= i && j < matrix.length; j++) {
      const other = matrix[j]!
      let rest = row[j]!
      for (let k = 0; k < j; k++) rest -= row[k]! * other[k]!
      row[j] = row === other ? Math.sqrt(rest) : rest / other[j]!
    }
  })
  // Lᵀ X = Y, from the last row on.
  for (const column of columns)
    for (let j = matrix.length - 1; j >= 0; j--) {
      const row = matrix[j]!
      column[j]! /= row[j]!
      for (let k = 0; k < j; k++) column[k]! -= row[k]! * column[j]!
    }
}
