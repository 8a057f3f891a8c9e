import { PROFILES } from '../../web/surfaces/profile'
import type { GratingDistribution } from './distribution'
import type { Figure } from './figures'
import type { SpiralDistribution } from './spiral'
import { readNumber, readWord, refusal, type NumberRange, type Texts } from './values'

export const SHAPES = { squares: 'Squares', discs: 'Discs', polygons: 'Polygons' } as const

/** What was read of a file, and the file, by whose name a recipe names it. */
export interface FileContent<T> {
  source: File
  content: T
}

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

/** What a recipe takes from files, where it does. */
export interface RecipeFiles {
  mask: FileContent<Figure> | null
  distribution: FileContent<GratingDistribution> | null
}

/** A foil of strewn shapes: the fields of a recipe of design 'stochastic', files by what is in them. */
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
  distribution: SpiralDistribution | { kind: 'file'; file: FileContent<GratingDistribution> }
  shape: keyof typeof SHAPES | 'mask'
  /** Of shape 'mask'; null for others. */
  mask: FileContent<Figure> | null
  /** Side of squares, diameter of discs, longer side of masks, mean distance of polygons' points, mm. */
  shape_mm: number
  /** How many times over shapes would cover the tile; null for polygons, which cover it once. */
  cover: number | null
}

/** The recipe that texts and files state; throws a DiffractionError that names the value that cannot be used. */
export function readRecipe(
  texts: Texts,
  { mask, distribution }: RecipeFiles = { mask: null, distribution: null },
): StochasticRecipe {
  const read = (name: RangeName): number => readNumber(name, texts[name], RANGES[name])
  const shape = mask === null ? readWord('shape', texts['shape'], SHAPES) : 'mask'
  const [size, tile, length] = [read('size'), read('tile_mm'), read('shape_mm')]
  const least = (2 * tile) / size
  if (length < least || length > tile / 2)
    throw refusal(
      'shape_mm',
      length,
      `two texels to half the tile, ${rounded(least)} to ${rounded(tile / 2)} mm`,
    )
  const cover = shape === 'polygons' ? null : read('cover')
  const most = MOST_SHAPES * (length / tile) ** 2 * (mask?.content.area ?? 1)
  if (cover !== null && cover > most)
    throw refusal('cover', cover, `at most ${rounded(most)} with shapes of that size`)
  return {
    ...{ kind: 'foil', size, tile_mm: tile, height: read('height') },
    ...{ profile: readWord('profile', texts['profile'], PROFILE_NAMES), seed: read('seed') },
    design: 'stochastic',
    distribution: distribution === null ? readSpiral(texts) : { kind: 'file', file: distribution },
    ...{ shape, mask, shape_mm: length, cover },
  }
}

function readSpiral(texts: Texts): SpiralDistribution {
  const read = (name: RangeName): number => readNumber(name, texts[name], RANGES[name])
  const [shortest, longest] = [read('shortest'), read('longest')]
  if (longest <= shortest) throw refusal('longest', longest, `above the shortest, ${shortest} µm`)
  return { kind: 'spiral', shortest, longest, spread: read('spread') }
}

/** The texts that state a recipe, but for what it takes from files. */
export function textsOf(recipe: StochasticRecipe): Texts {
  const { shape, shape_mm, cover, distribution, size, tile_mm, height, profile, seed } = recipe
  const numbers = {
    shape_mm,
    ...(cover !== null && { cover }),
    ...(distribution.kind === 'spiral' && {
      shortest: distribution.shortest,
      longest: distribution.longest,
      spread: distribution.spread,
    }),
    ...{ size, tile_mm, height, seed },
  }
  return {
    shape,
    ...Object.fromEntries(Object.entries(numbers).map(([name, value]) => [name, String(value)])),
    profile,
  }
}

/** Whether a recipe takes something from files. */
export function hasFiles({ mask, distribution }: StochasticRecipe): boolean {
  return mask !== null || distribution.kind === 'file'
}

/** The recipe as `diffraction bake` reads it. */
export function jsonOf(recipe: StochasticRecipe): Record<string, unknown> {
  const { mask, distribution } = recipe
  return {
    ...recipe,
    mask: mask?.source.name ?? null,
    distribution:
      distribution.kind === 'file'
        ? { kind: 'file', file: distribution.file.source.name }
        : distribution,
  }
}

/** To four significant digits. */
function rounded(value: number): number {
  return Number(value.toPrecision(4))
}
