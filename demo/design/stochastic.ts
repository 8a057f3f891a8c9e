import { roundHalfEven } from '../numbers/round-half-even'
import type { FoilTexels } from './foil-map'
import { nearestPoints } from './nearest-points'
import { NumpyRandom } from './numpy-random'
import { Spiral } from './spiral'
import type { Shape, StochasticRecipe } from './stochastic-recipe'
import { part, type Work } from './work'

/** Texels that are looked at, and numbers that are drawn, before work may be left. */
const AT_ONCE = 1 << 14
const DRAWN_AT_ONCE = 1 << 10

/** The foil of a recipe, the same as `precompute.foils.stochastic` makes of it. */
export function* stochasticTexels(recipe: StochasticRecipe): Work<FoilTexels> {
  const { size } = recipe
  const random = new NumpyRandom(recipe.seed)
  const index = yield* part(0, 0.5, texture(recipe, random))
  const last = yield* part(0.5, 0.51, largest(index, size))
  const spiral = new Spiral(recipe.distribution)
  const gratings = yield* part(0.51, 0.9, spiral.sample(random, last + 1))
  const values = new Float64Array(4 * size * size)
  for (let texel = 0; texel < index.length; texel++) {
    if (texel % size === 0) yield 0.9 + (0.1 * texel) / index.length
    const shape = index[texel]!
    // What is bare has the last shape's grating.
    const drawn = shape < 0 ? last : shape
    const turned = 2 * gratings.orientation[drawn]!
    values[4 * texel] = Math.cos(turned)
    values[4 * texel + 1] = Math.sin(turned)
    values[4 * texel + 2] = gratings.frequency[drawn]!
    values[4 * texel + 3] = shape < 0 ? 0 : 1
  }
  return { rows: size, columns: size, values }
}

/** The shape at each texel, rows from the top; −1 where there is none. */
function* texture(recipe: StochasticRecipe, random: NumpyRandom): Work<Int32Array> {
  const { size, shape_mm, tile_mm, cover } = recipe
  const side = shape_mm / tile_mm
  if (cover === null) {
    const points = new Float64Array(2 * roundHalfEven(1 / side ** 2))
    for (let i = 0; i < points.length; i++) {
      if (i % DRAWN_AT_ONCE === 0) yield (0.3 * i) / points.length
      points[i] = random.next()
    }
    return yield* part(0.3, 1, nearestPoints(points, size))
  }
  const count = Math.ceil(cover / (side ** 2 * areaOf(recipe.shape)))
  return yield* strewn(recipe.shape, count, random, side, size)
}

function* largest(values: Int32Array, atOnce: number): Work<number> {
  let most = -1
  for (let i = 0; i < values.length; i++) {
    if (i % atOnce === 0) yield i / values.length
    most = Math.max(most, values[i]!)
  }
  return most
}

/** Shapes painted over one another, the last on top; what leaves the tile on one side comes in on the other. */
function* strewn(
  shape: Shape,
  count: number,
  random: NumpyRandom,
  side: number,
  size: number,
): Work<Int32Array> {
  const uppermost = new Int32Array(size * size).fill(-1)
  const wide = Math.ceil(side * size) + 1
  let looked = 0
  for (let i = 0; i < count; i++) {
    const [u, v] = [random.next(), random.next()]
    const middle = [u * size, (1 - v) * size] as const
    const first = middle.map((at) => Math.ceil(at - (side * size) / 2 - 0.5)) as [number, number]
    for (let dy = 0; dy < wide; dy++) {
      looked += wide
      if (looked >= AT_ONCE) {
        looked = 0
        yield i / count
      }
      const y = -(first[1] + dy + 0.5 - middle[1]) / (side * size)
      if (Math.abs(y) > 0.5) continue
      const row = (((first[1] + dy) % size) + size) % size
      for (let dx = 0; dx < wide; dx++) {
        const x = (first[0] + dx + 0.5 - middle[0]) / (side * size)
        if (Math.abs(x) > 0.5 || !isOn(shape, x, y)) continue
        uppermost[row * size + ((((first[0] + dx) % size) + size) % size)] = i
      }
    }
  }
  return uppermost
}

/** Whether (x, y) lies on the shape, within the box of ±½. */
function isOn(shape: Shape, x: number, y: number): boolean {
  return shape === 'squares' || x ** 2 + y ** 2 <= 0.25
}

/** Share of its box that a shape covers, to a thousandth. */
function areaOf(shape: Shape): number {
  const samples = 512
  let count = 0
  for (let row = 0; row < samples; row++)
    for (let column = 0; column < samples; column++)
      if (isOn(shape, (column + 0.5) / samples - 0.5, (row + 0.5) / samples - 0.5)) count++
  return count / samples ** 2
}
