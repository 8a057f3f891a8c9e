import type { Work } from './work'

/** Points in a cell of the grid by which they are found, about. */
const PER_CELL = 2
/** Points that are sorted before work may be left. */
const AT_ONCE = 4096

/**
 * Which of some points is nearest to each texel's centre, on a tile whose opposite sides are one.
 *
 * @param points - x to the right and y up, 0 to 1, of one after the other; one or more
 * @returns indices, rows from the top
 */
export function* nearestPoints(points: Float64Array, size: number): Work<Int32Array> {
  const count = points.length / 2
  const cells = Math.max(Math.floor(Math.sqrt(count / PER_CELL)), 1)
  const grid: number[][] = Array.from({ length: cells * cells }, () => [])
  for (let i = 0; i < count; i++) {
    if (i % AT_ONCE === 0) yield 0
    const [x, y] = [points[2 * i]!, points[2 * i + 1]!]
    grid[Math.floor(y * cells) * cells + Math.floor(x * cells)]!.push(i)
  }
  const nearest = new Int32Array(size * size)
  for (let row = 0; row < size; row++) {
    yield row / size
    const y = (size - 1 - row + 0.5) / size
    for (let column = 0; column < size; column++) {
      const x = (column + 0.5) / size
      nearest[row * size + column] = nearestTo(x, y)
    }
  }
  return nearest

  function nearestTo(x: number, y: number): number {
    const [cx, cy] = [Math.floor(x * cells), Math.floor(y * cells)]
    let [best, least] = [-1, Infinity]
    const look = (dx: number, dy: number): void => {
      const cell = ((cy + dy + cells) % cells) * cells + ((cx + dx + cells) % cells)
      for (const i of grid[cell]!) {
        const distance = Math.hypot(wrapped(points[2 * i]! - x), wrapped(points[2 * i + 1]! - y))
        if (distance < least) [best, least] = [i, distance]
      }
    }
    // Ring by ring of cells: what lies beyond ring r is further than r cells.
    for (let ring = 0; ring <= Math.ceil(cells / 2) && least > (ring - 1) / cells; ring++)
      for (let d = -ring; d <= ring; d++) {
        if (Math.abs(d) === ring) for (let e = -ring; e <= ring; e++) look(d, e)
        else for (const e of [-ring, ring]) look(d, e)
      }
    return best
  }
}

/** A difference of places on a circle of length 1, −½ to ½. */
function wrapped(difference: number): number {
  return difference - Math.round(difference)
}
