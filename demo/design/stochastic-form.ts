import { make } from '../ui/elements'
import type { GratingDistribution } from './distribution'
import { readDistribution } from './distribution-file'
import { ChoiceField, FileField, fillForm, NumberField, readForm, type AnyField } from './fields'
import type { Figure } from './figures'
import { readMask } from './mask'
import {
  PROFILE_NAMES,
  RANGES,
  readRecipe,
  SHAPES,
  textsOf,
  type RangeName,
  type StochasticRecipe,
} from './stochastic-recipe'

const SHAPES_AND_MASK = { ...SHAPES, mask: 'Of a picture' } as const
const DISTRIBUTIONS = { spiral: 'By orientation', file: 'Of a file' } as const

/** The fields of a foil of strewn shapes, by the names of `diffraction design stochastic`. */
export class StochasticForm {
  readonly element = make('div', 'form')
  readonly fields: readonly AnyField[]
  readonly #shape: ChoiceField<keyof typeof SHAPES_AND_MASK>
  readonly #mask: FileField<Figure>
  readonly #distribution: ChoiceField<keyof typeof DISTRIBUTIONS>
  readonly #file: FileField<GratingDistribution>
  readonly #numbers: Record<RangeName, NumberField>

  constructor(onChange: () => void) {
    const field = (name: RangeName, label: string, value: number): NumberField =>
      new NumberField({ name, label, value, ...RANGES[name] }, onChange)
    const onChoice = (): void => {
      this.#offer()
      onChange()
    }
    this.#shape = new ChoiceField('shape', 'Shapes', SHAPES_AND_MASK, onChoice)
    this.#mask = new FileField(
      {
        ...{ name: 'mask', label: 'Picture, light on dark', type: 'image/png' },
        expected: 'a PNG file, whose light and opaque half is the shape',
      },
      readMask,
      onChange,
    )
    this.#distribution = new ChoiceField('gratings', 'Periods', DISTRIBUTIONS, onChoice)
    this.#file = new FileField(
      {
        ...{ name: 'distribution', label: 'Distribution', type: '.json,application/json' },
        expected: 'a JSON file, as diffraction acquire flash writes it of strewn shapes',
      },
      readDistribution,
      onChange,
    )
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
    const { shape_mm, cover, size, tile_mm, height, seed, ...periods } = this.#numbers
    const first = [
      ...[this.#shape, this.#mask, shape_mm, cover],
      ...[this.#distribution, this.#file, ...Object.values(periods)],
    ]
    const more = [size, tile_mm, height, profile]
    this.fields = [...first, seed, ...more]
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
        'Strews shapes over a tile. Periods grow with orientation over the half turn, each about Gaussian, or are those of a file.',
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
      (texts) =>
        readRecipe(texts, {
          mask: this.#shape.read() === 'mask' ? this.#mask.read() : null,
          distribution: this.#distribution.read() === 'file' ? this.#file.read() : null,
        }),
    )
  }

  /** Takes a recipe's values over. */
  fill(recipe: StochasticRecipe): void {
    const { mask, distribution } = recipe
    fillForm(this.fields, { ...textsOf(recipe), gratings: distribution.kind })
    if (mask !== null) this.#mask.hold(mask)
    if (distribution.kind === 'file') this.#file.hold(distribution.file)
    this.#offer()
  }

  /** The fields that mean something: polygons, for one, cover the tile once. */
  #offer(): void {
    const shape = this.#shape.read()
    const isOfFile = this.#distribution.read() === 'file'
    const { cover, shortest, longest, spread } = this.#numbers
    this.#mask.element.hidden = shape !== 'mask'
    cover.element.hidden = shape === 'polygons'
    this.#file.element.hidden = !isOfFile
    for (const { element } of [shortest, longest, spread]) element.hidden = isOfFile
  }
}
