import { make } from '../ui/elements'
import { ChoiceField, fillForm, NumberField, readForm, type AnyField } from './fields'
import {
  PROFILE_NAMES,
  RANGES,
  readRecipe,
  SHAPES,
  textsOf,
  type RangeName,
  type Shape,
  type StochasticRecipe,
} from './stochastic-recipe'

/** The fields of a foil of strewn shapes, by the names of `diffraction design stochastic`. */
export class StochasticForm {
  readonly element = make('div', 'form')
  readonly fields: readonly AnyField[]
  readonly #shape: ChoiceField<Shape>
  readonly #numbers: Record<RangeName, NumberField>

  constructor(onChange: () => void) {
    const field = (name: RangeName, label: string, value: number): NumberField =>
      new NumberField({ name, label, value, ...RANGES[name] }, onChange)
    this.#shape = new ChoiceField('shape', 'Shapes', SHAPES, () => {
      this.#offer()
      onChange()
    })
    this.#numbers = {
      shape_mm: field('shape_mm', 'Size of a shape', 0.8),
      cover: field('cover', 'Cover, times over', 5),
      shortest: field('shortest', 'Shortest period', 1.2),
      longest: field('longest', 'Longest period', 2.4),
      spread: field('spread', 'Spread of periods', 0.02),
      size: field('size', 'Texels a side', 512),
      tile_mm: field('tile_mm', 'Side of the tile', 25),
      height: field('height', 'Relief height', 0.15),
      seed: field('seed', 'Seed', 1),
    }
    const profile = new ChoiceField('profile', 'Profile', PROFILE_NAMES, onChange)
    const { size, tile_mm, height, seed, ...shown } = this.#numbers
    const first = [this.#shape, ...Object.values(shown)]
    const more = [size, tile_mm, height, profile]
    this.fields = [...first, seed, ...more] as AnyField[]
    const reseed = make('button', 'wide', 'Another seed')
    reseed.type = 'button'
    reseed.addEventListener('click', () => {
      seed.text = String(Math.floor(Math.random() * 2 ** 32))
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
    return readForm(
      this.fields.filter(({ element }) => !element.hidden),
      readRecipe,
    )
  }

  /** Takes a recipe's values over. */
  fill(recipe: StochasticRecipe): void {
    fillForm(this.fields, textsOf(recipe))
    this.#offer()
  }

  /** Polygons cover the tile once. */
  #offer(): void {
    this.#numbers.cover.element.hidden = this.#shape.read() === 'polygons'
  }
}
