import { PROFILES } from '../../web/surfaces/profile'
import { make } from '../ui/elements'
import { ChoiceField, NumberField, readForm, refusal, type AnyField } from './fields'
import { SHAPES, type Shape, type StochasticRecipe } from './stochastic'

/** Baked profiles, by the names that recipes have. */
const PROFILE_NAMES = Object.fromEntries(
  PROFILES.map((name) => [name, name.charAt(0).toUpperCase() + name.slice(1)]),
)

/** The fields of a foil of strewn shapes, by the names of `diffraction design stochastic`. */
export class StochasticForm {
  readonly element = make('div', 'form')
  readonly fields: readonly AnyField[]
  readonly #shape: ChoiceField<Shape>
  readonly #profile: ChoiceField<string>
  readonly #numbers: Record<
    | 'shape_mm'
    | 'cover'
    | 'shortest'
    | 'longest'
    | 'spread'
    | 'size'
    | 'tile_mm'
    | 'height'
    | 'seed',
    NumberField
  >

  constructor(onChange: () => void) {
    const field = (
      name: string,
      label: string,
      unit: string,
      [min, max]: readonly [number, number],
      value: number,
      isWhole = false,
    ): NumberField => new NumberField({ name, label, unit, min, max, value, isWhole }, onChange)
    this.#shape = new ChoiceField('shape', 'Shapes', SHAPES, () => {
      this.#offer()
      onChange()
    })
    this.#numbers = {
      shape_mm: field('shape_mm', 'Size of a shape', 'mm', [0.01, 500], 0.8),
      cover: field('cover', 'Cover, times over', '', [0.01, 20], 5),
      shortest: field('shortest', 'Shortest period', 'µm', [0.4, 20], 1.2),
      longest: field('longest', 'Longest period', 'µm', [0.4, 20], 2.4),
      spread: field('spread', 'Spread of periods', '', [0.001, 0.2], 0.02),
      size: field('size', 'Texels a side', '', [16, 1024], 512, true),
      tile_mm: field('tile_mm', 'Side of the tile', 'mm', [0.1, 1000], 25),
      height: field('height', 'Relief height', 'µm', [0.005, 5], 0.15),
      seed: field('seed', 'Seed', '', [0, Number.MAX_SAFE_INTEGER], 1, true),
    }
    this.#profile = new ChoiceField('profile', 'Profile', PROFILE_NAMES, onChange)
    const { size, tile_mm, height, seed, ...shown } = this.#numbers
    const first = [this.#shape, ...Object.values(shown)]
    const more = [size, tile_mm, height, this.#profile]
    this.fields = [...first, seed, ...more] as AnyField[]
    const reseed = make('button', 'wide', 'Another seed')
    reseed.type = 'button'
    reseed.addEventListener('click', () => {
      seed.value = Math.floor(Math.random() * 2 ** 32)
      onChange()
    })
    this.element.append(
      make(
        'p',
        'note',
        'Strews shapes over a tile. Periods grow with orientation over the half turn, each about Gaussian.',
      ),
      ...[...first, seed].map(({ element }) => element),
      reseed,
      ...more.map(({ element }) => element),
    )
    this.#offer()
  }

  /** The recipe, or null where a field is refused. */
  read(): StochasticRecipe | null {
    const isStrewn = this.#shape.read() !== 'polygons'
    const read = this.fields.filter((field) => isStrewn || field !== this.#numbers.cover)
    return readForm(read, () => {
      const n = this.#numbers
      const [shortest, longest] = [n.shortest.read(), n.longest.read()]
      if (longest <= shortest)
        throw refusal('longest', longest, `above the shortest, ${shortest} µm`)
      const [size, tile, length] = [n.size.read(), n.tile_mm.read(), n.shape_mm.read()]
      const least = (2 * tile) / size
      if (length < least || length > tile / 2)
        throw refusal(
          'shape_mm',
          length,
          `two texels to half the tile, ${Number(least.toPrecision(4))} to ${Number((tile / 2).toPrecision(4))} mm`,
        )
      return {
        ...{ kind: 'foil' as const, size, tile_mm: tile, height: n.height.read() },
        ...{ profile: this.#profile.read(), seed: n.seed.read(), design: 'stochastic' as const },
        distribution: { kind: 'spiral' as const, shortest, longest, spread: n.spread.read() },
        ...{ shape: this.#shape.read(), mask: null, shape_mm: length },
        cover: isStrewn ? n.cover.read() : null,
      }
    })
  }

  /** Polygons cover the tile once. */
  #offer(): void {
    this.#numbers.cover.element.hidden = this.#shape.read() === 'polygons'
  }
}
