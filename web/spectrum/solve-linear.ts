/**
 * Solves A X = B by Gaussian elimination with row pivots.
 *
 * @param matrix - A, rows of a square matrix that is not singular
 * @param right - B, as many rows
 * @returns X, the shape of B
 */
export function solveLinear(
  matrix: readonly (readonly number[])[],
  right: readonly (readonly number[])[],
): number[][] {
  const size = matrix.length
  const rows = matrix.map((row, i) => Float64Array.from([...row, ...right[i]!]))
  for (let k = 0; k < size; k++) {
    let pivot = k
    for (let i = k + 1; i < size; i++)
      if (Math.abs(rows[i]![k]!) > Math.abs(rows[pivot]![k]!)) pivot = i
    const row = rows[pivot]!
    rows[pivot] = rows[k]!
    rows[k] = row
    for (let i = 0; i < size; i++) {
      if (i === k) continue
      const other = rows[i]!
      const factor = other[k]! / row[k]!
      for (let c = k; c < row.length; c++) other[c]! -= factor * row[c]!
    }
  }
  return rows.map((row, k) => Array.from(row.subarray(size), (value) => value / row[k]!))
}
