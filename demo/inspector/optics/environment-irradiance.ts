/** Texels of a block along either axis. */
const BLOCK = 16
/** Of a block: ∫ L ω dω of R, G and B, three numbers each, its middle's direction, and the sine of its angular radius. */
const NUMBERS = 13

/** Texels of an environment: linear sRGB, never negative, rows from the picture's bottom, as textures have them. */
export interface Texels {
  width: number
  height: number
  rgb: Float32Array
}

/**
 * Irradiance from an environment, ∫ L max(n·ω, 0) dω. Blocks of texels that lie on one side of the horizon count by their
 * vectors ∫ L ω dω; of the others each texel does.
 */
export class EnvironmentIrradiance {
  readonly #texels: Texels
  readonly #blocks: Float64Array
  readonly #across: number
  readonly #up: number
  /** Of columns: cos and sin of the azimuth, and of rows: y, its distance from the axis, and the solid angle of a texel. */
  readonly #columns: Float64Array
  readonly #rows: Float64Array

  constructor(texels: Texels) {
    const { width, height } = texels
    this.#texels = texels
    this.#columns = new Float64Array(2 * width)
    for (let column = 0; column < width; column++) {
      const azimuth = ((column + 0.5) / width - 0.5) * 2 * Math.PI
      this.#columns.set([Math.cos(azimuth), Math.sin(azimuth)], 2 * column)
    }
    this.#rows = new Float64Array(3 * height)
    for (let row = 0; row < height; row++) {
      const rise = ((row + 0.5) / height - 0.5) * Math.PI
      const band = 2 * Math.cos(rise) * Math.sin(Math.PI / (2 * height))
      this.#rows.set([Math.sin(rise), Math.cos(rise), (band * 2 * Math.PI) / width], 3 * row)
    }
    this.#across = Math.ceil(width / BLOCK)
    this.#up = Math.ceil(height / BLOCK)
    this.#blocks = new Float64Array(NUMBERS * this.#across * this.#up)
    for (let block = 0; block < this.#across * this.#up; block++) this.#sumUp(block)
  }

  /** @param normal - a unit vector, as the picture has directions; adds to three numbers of linear sRGB */
  add(x: number, y: number, z: number, sum: number[]): void {
    const blocks = this.#blocks
    for (let block = 0; block < this.#across * this.#up; block++) {
      const at = NUMBERS * block
      const height = x * blocks[at + 9]! + y * blocks[at + 10]! + z * blocks[at + 11]!
      const reach = blocks[at + 12]!
      if (height <= -reach) continue
      if (height < reach) {
        this.#eachTexel(block, (a, b, c, size, texel) => {
          const share = Math.max(x * a + y * b + z * c, 0) * size
          for (let k = 0; k < 3; k++) sum[k]! += share * this.#texels.rgb[texel + k]!
        })
        continue
      }
      for (let k = 0; k < 3; k++) {
        const of = at + 3 * k
        sum[k]! += x * blocks[of]! + y * blocks[of + 1]! + z * blocks[of + 2]!
      }
    }
  }

  #sumUp(block: number): void {
    const at = NUMBERS * block
    const blocks = this.#blocks
    const middle = [0, 0, 0]
    this.#eachTexel(block, (x, y, z, size, texel) => {
      for (let k = 0; k < 3; k++) {
        const light = size * this.#texels.rgb[texel + k]!
        blocks[at + 3 * k]! += light * x
        blocks[at + 3 * k + 1]! += light * y
        blocks[at + 3 * k + 2]! += light * z
      }
      middle[0]! += x
      middle[1]! += y
      middle[2]! += z
    })
    const length = Math.hypot(...middle)
    const [x, y, z] = middle.map((component) => component / length) as [number, number, number]
    let closest = 1
    this.#eachTexel(block, (a, b, c) => (closest = Math.min(closest, x * a + y * b + z * c)))
    // All of a block is above the horizon where the sine of its middle's height is above that of its radius; blocks of
    // more than a hemisphere's half are always looked into.
    const reach = closest > 0 ? Math.sqrt(1 - closest ** 2) : 1
    blocks.set([x, y, z, reach], at + 9)
  }

  #eachTexel(
    block: number,
    visit: (x: number, y: number, z: number, solidAngle: number, texel: number) => void,
  ): void {
    const { width, height } = this.#texels
    const firstRow = BLOCK * Math.floor(block / this.#across)
    const firstColumn = BLOCK * (block % this.#across)
    for (let row = firstRow; row < Math.min(firstRow + BLOCK, height); row++) {
      const [y, flat, size] = [
        this.#rows[3 * row]!,
        this.#rows[3 * row + 1]!,
        this.#rows[3 * row + 2]!,
      ]
      for (let column = firstColumn; column < Math.min(firstColumn + BLOCK, width); column++)
        visit(
          flat * this.#columns[2 * column]!,
          y,
          flat * this.#columns[2 * column + 1]!,
          size,
          3 * (row * width + column),
        )
    }
  }
}
