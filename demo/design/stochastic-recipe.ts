import { PROFILES } from '../../web/surfaces/profile'
import { readNumber, readWord, refusal, type NumberRange, type Texts } from './values'

export const SHAPES = { squares: 'Squares', discs: 'Discs', polygons: 'Polygons' } as const
export type Shape = keyof typeof SHAPES

/** Baked profiles, by the names that recipes have. */
export const PROFILE_NAMES = Object.fromEntries(
  PROFILES.map((name) => [name, name.charAt(0).toUpperCase() + name.slice(1)]),
)

/** What the recipe's numbers may be, by their names. */
export const RANGES = {
  shape_mm: { unit: 'mm', min: 0.01, max: 500 },
  cover: { unit: '', min: 0.01, max: 20 },
  shortest: { unit: 'µm', min: 0.4, max: 20 },
  longest: { unit: 'µm', min: 0.4, max: 20 },
  spread: { unit: '', min: 0.001, max: 0.2 },
  size: { unit: '', min: 16, max: 1024, isWhole: true },
  tile_mm: { unit: 'mm', min: 0.1, max: 1000 },
  height: { unit: 'µm', min: 0.005, max: 5 },
  seed: { unit: '', min: 0, max: Number.MAX_SAFE_INTEGER, isWhole: true },
} as const satisfies Record<string, NumberRange>
export type RangeName = keyof typeof RANGES

/** Shapes that are strewn at most, if they were squares: the smallest cover the largest tile seven times over. */
const MOST_SHAPES = 2_000_000

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

/** The recipe that texts state; throws a DiffractionError that names the one that cannot be used. */
export function readRecipe(texts: Texts): StochasticRecipe {
  const read = (name: RangeName): number => readNumber(name, texts[name], RANGES[name])
  const shape = readWord('shape', texts['shape'], SHAPES)
  const [size, tile, length] = [read('size'), read('tile_mm'), read('shape_mm')]
  const [shortest, longest] = [read('shortest'), read('longest')]
  if (longest <= shortest) throw refusal('longest', longest, `above the shortest, ${shortest} µm`)
  const least = (2 * tile) / size
  if (length < least || length > tile / 2)
    throw refusal(
      'shape_mm',
      length,
      `two texels to half the tile, ${rounded(least)} to ${rounded(tile / 2)} mm`,
    )
  const cover = shape === 'polygons' ? null : read('cover')
  const most = MOST_SHAPES * (length / tile) ** 2
  if (cover !== null && cover > most)
    throw refusal('cover', cover, `at most ${rounded(most)} with shapes of that size`)
  return {
    ...{ kind: 'foil', size, tile_mm: tile, height: read('height') },
    ...{ profile: readWord('profile', texts['profile'], PROFILE_NAMES), seed: read('seed') },
    design: 'stochastic',
    distribution: { kind: 'spiral', shortest, longest, spread: read('spread') },
    ...{ shape, mask: null, shape_mm: length, cover },
  }
}

/** The texts that state a recipe. */
export function textsOf(recipe: StochasticRecipe): Texts {
  const { shape, shape_mm, cover, distribution, size, tile_mm, height, profile, seed } = recipe
  const { shortest, longest, spread } = distribution
  return {
    shape,
    shape_mm: String(shape_mm),
    ...(cover !== null && { cover: String(cover) }),
    ...{ shortest: String(shortest), longest: String(longest), spread: String(spread) },
    ...{ size: String(size), tile_mm: String(tile_mm), height: String(height) },
    ...{ profile, seed: String(seed) },
  }
}

/** To four significant digits. */
function rounded(value: number): number {
  return Number(value.toPrecision(4))
}
