import type { LocalEnvironment } from './environment-light'

/** At most so many readings along either axis stand for one cell near the horizon, where the sphere is steep. */
const MOST_PARTS = 4
/** A part beyond which one reading would pass over texels. */
const WIDEST_PART = 0.75

/** Of a cell: R, G, B summed over its part above the horizon, and the size of that part, both over (x, y). */
export const CHANNELS = 4

/**
 * The environment above a surface in cells of the disc of (x, y) = (ω_i)_tb, even in ψ = asin x and β = asin y: in steps
 * that texels set, also towards the horizon. A column of cells is read when it is first asked for.
 */
export class EnvironmentCells {
  /** Step of ψ and of β, rad. */
  readonly step: number
  /** Cells along ψ. */
  readonly columns: number
  /** The first row that is kept, of as many as there are columns, and how many are. */
  readonly firstRow: number
  readonly rows: number
  /** x of columns and y of rows, at the middles of all cells. */
  readonly sines: Float64Array
  /** {@link CHANNELS} a cell, column by column; of columns that have been read. */
  readonly cells: Float64Array
  readonly #environment: LocalEnvironment
  readonly #isRead: Uint8Array

  /**
   * @param step - of ψ and β, about; rad
   * @param low - of y, and
   * @param high - of y: nothing is read beyond
   */
  constructor(environment: LocalEnvironment, step: number, low: number, high: number) {
    this.#environment = environment
    this.columns = Math.ceil(Math.PI / step)
    this.step = Math.PI / this.columns
    this.firstRow = Math.max(Math.floor(this.at(low)), 0)
    this.rows = Math.min(Math.ceil(this.at(high)), this.columns - 1) - this.firstRow + 1
    this.sines = Float64Array.from({ length: this.columns }, (_, i) =>
      Math.sin((i + 0.5) * this.step - Math.PI / 2),
    )
    this.cells = new Float64Array(CHANNELS * this.columns * this.rows)
    this.#isRead = new Uint8Array(this.columns)
  }

  /** Column or row at an x or y, held within the disc; whole numbers are middles of cells. */
  at(sine: number): number {
    const angle = Math.asin(Math.min(Math.max(sine, -1), 1))
    return (angle + Math.PI / 2) / this.step - 0.5
  }

  /** Reads what has not been read of these columns. */
  read(first: number, last: number): void {
    for (let column = first; column <= last; column++) {
      if (this.#isRead[column]!) continue
      this.#isRead[column] = 1
      for (let row = 0; row < this.rows; row++) this.#readCell(column, row)
    }
  }

  #readCell(column: number, row: number): void {
    const at = CHANNELS * (column * this.rows + row)
    const ψ = (column + 0.5) * this.step - Math.PI / 2
    const β = (row + this.firstRow + 0.5) * this.step - Math.PI / 2
    const [width, height] = [Math.cos(ψ) * this.step, Math.cos(β) * this.step]
    const x = this.sines[column]!
    const y = this.sines[row + this.firstRow]!
    const squared = 1 - x * x - y * y
    // No corner of the cell is above the horizon.
    if (squared < -2 * (width + height)) return
    // A step dr along the radius is dr/cosθ on the sphere; cosθ of the middle, or of what lies in the cell.
    const cosine = Math.sqrt(Math.max(squared, 0.5 * (width + height)))
    const widest = Math.max(width, height) / (cosine * WIDEST_PART * this.#environment.texel)
    const parts = Math.min(Math.max(Math.ceil(widest), 1), MOST_PARTS)
    const share = (width * height) / parts ** 2
    for (let i = 0; i < parts; i++)
      for (let j = 0; j < parts; j++) {
        const px = x + ((i + 0.5) / parts - 0.5) * width
        const py = y + ((j + 0.5) / parts - 0.5) * height
        const z = 1 - px * px - py * py
        if (z <= 0) continue
        this.#environment.add(px, py, Math.sqrt(z), share, this.cells, at)
        this.cells[at + 3]! += share
      }
  }
}
