import type { Steps } from '../../web/steps'
import { roundHalfEven } from '../numbers/round-half-even'
import type { FoilTexels } from './foil-map'
import { nearestPoints } from './nearest-points'
import { NumpyRandom } from './numpy-random'
import { Spiral } from './spiral'

export const SHAPES = { squares: 'Squares', discs: 'Discs', polygons: 'Polygons' } as const
export type Shape = keyof typeof SHAPES

/** A foil of strewn shapes: the fields of a recipe of design 'stochastic', as `diffraction bake` reads them. */
export interface StochasticRecipe {
  kind: 'foil'
  /** Texels along each side of the tile. */
  size: number
  /** Its side, mm. */
  tile_mm: number
  /** Of all gratings, µm. */
  height: number
  profile: string
  seed: number
  design: 'stochastic'
  distribution: { kind: 'spiral'; shortest: number; longest: number; spread: number }
  shape: Shape
  mask: null
  /** Side of squares, diameter of discs, mean distance of polygons' points, mm. */
  shape_mm: number
  /** How many times over shapes would cover the tile; null for polygons, which cover it once. */
  cover: number | null
}

/** Shapes that are looked at before work may be left. */
const AT_ONCE = 256

/** The foil of a recipe, the same as `precompute.foils.stochastic` makes of it. */
export function* stochasticTexels(recipe: StochasticRecipe): Steps<FoilTexels> {
  const { size } = recipe
  const random = new NumpyRandom(recipe.seed)
  const spiral = new Spiral(recipe.distribution)
  const index = yield* texture(recipe, random)
  let last = -1
  for (const shape of index) last = Math.max(last, shape)
  const gratings = yield* spiral.sample(random, last + 1)
  const values = new Float64Array(4 * size * size)
  for (let texel = 0; texel < index.length; texel++) {
    if (texel % size === 0) yield
    const shape = index[texel]!
    // What is bare has the last shape's grating.
    const { orientation, frequency } = gratings[shape < 0 ? last : shape]!
    values[4 * texel] = Math.cos(2 * orientation)
    values[4 * texel + 1] = Math.sin(2 * orientation)
    values[4 * texel + 2] = frequency
    values[4 * texel + 3] = shape < 0 ? 0 : 1
  }
  return { rows: size, columns: size, values }
}

/** The shape at each texel, rows from the top; −1 where there is none. */
function* texture(
  { size, tile_mm, shape, shape_mm, cover }: StochasticRecipe,
  random: NumpyRandom,
): Steps<Int32Array> {
  const side = shape_mm / tile_mm
  const count =
    cover === null ? roundHalfEven(1 / side ** 2) : Math.ceil(cover / (side ** 2 * areaOf(shape)))
  const places: [number, number][] = []
  for (let i = 0; i < count; i++) {
    if (i % AT_ONCE === 0) yield
    places.push([random.next(), random.next()])
  }
  return cover === null
    ? yield* nearestPoints(places, size)
    : yield* strewn(shape, places, side, size)
}

/** Shapes painted over one another, the last on top; what leaves the tile on one side comes in on the other. */
function* strewn(
  shape: Shape,
  places: readonly (readonly [number, number])[],
  side: number,
  size: number,
): Steps<Int32Array> {
  const uppermost = new Int32Array(size * size).fill(-1)
  const wide = Math.ceil(side * size) + 1
  for (const [i, [u, v]] of places.entries()) {
    if (i % AT_ONCE === 0) yield
    const middle = [u * size, (1 - v) * size] as const
    const first = middle.map((at) => Math.ceil(at - (side * size) / 2 - 0.5)) as [number, number]
    for (let dy = 0; dy < wide; dy++) {
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
