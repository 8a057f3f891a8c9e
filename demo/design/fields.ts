import { DiffractionError } from '../../web'
import { within } from '../../web/validation'
import { make, uniqueId } from '../ui/elements'

const OWNER = 'design'

export interface NumberFieldOptions {
  /** As in the recipe, and in errors. */
  name: string
  label: string
  unit: string
  min: number
  max: number
  isWhole?: boolean
  value: number
}

/** A labelled field of a form, and room beside it for what is wrong with it. */
abstract class Field<T> {
  readonly element = make('div', 'field')
  readonly #error = make('p', 'field-error')

  constructor(
    readonly name: string,
    label: string,
    protected readonly input: HTMLInputElement | HTMLSelectElement,
    unit: string,
    onChange: () => void,
  ) {
    input.id = uniqueId()
    input.name = name
    this.#error.id = uniqueId()
    this.#error.hidden = true
    input.setAttribute('aria-describedby', this.#error.id)
    const text = make('label', '', label)
    text.htmlFor = input.id
    const box = make('span', 'box', input, ...(unit === '' ? [] : [make('span', 'unit', unit)]))
    this.element.append(text, box, this.#error)
    input.addEventListener('input', onChange)
  }

  /** Throws a DiffractionError where it cannot be used. */
  abstract read(): T

  /** Says what is wrong with it; nothing: it is good. */
  refuse(error: DiffractionError | null): void {
    this.#error.hidden = error === null
    this.#error.textContent = error === null ? '' : `Expected ${error.expected}.`
    this.input.setAttribute('aria-invalid', String(error !== null))
  }
}

export class NumberField extends Field<number> {
  readonly #options: NumberFieldOptions

  constructor(options: NumberFieldOptions, onChange: () => void) {
    const input = make('input', '')
    Object.assign(input, {
      // Not of type number, which hides what was typed where it is none.
      ...{ type: 'text', inputMode: options.isWhole ? 'numeric' : 'decimal' },
      ...{ value: String(options.value), autocomplete: 'off', spellcheck: false },
    })
    super(options.name, options.label, input, options.unit, onChange)
    this.#options = options
  }

  read(): number {
    const { name, min, max, unit, isWhole } = this.#options
    const text = this.input.value.trim().replace(',', '.')
    const value = text === '' ? NaN : Number(text)
    within(OWNER, name, value, min, max, unit)
    if (isWhole && !Number.isInteger(value))
      throw refusal(name, value, `a whole number from ${min} to ${max}`)
    return value
  }

  set value(value: number) {
    this.input.value = String(value)
  }
}

export class ChoiceField<T extends string> extends Field<T> {
  readonly #options: Readonly<Record<T, string>>

  constructor(
    name: string,
    label: string,
    options: Readonly<Record<T, string>>,
    onChange: () => void,
  ) {
    const select = make('select', '')
    select.append(
      ...Object.entries<string>(options).map(([value, text]) => new Option(text, value)),
    )
    super(name, label, select, '', onChange)
    this.#options = options
  }

  read(): T {
    return Object.keys(this.#options).find((value) => value === this.input.value) as T
  }
}

export class TextField extends Field<string> {
  constructor(
    name: string,
    label: string,
    value: string,
    private readonly pattern: RegExp,
    private readonly expected: string,
    onChange: () => void,
  ) {
    const input = make('input', '')
    Object.assign(input, { type: 'text', value, autocomplete: 'off', spellcheck: false })
    super(name, label, input, '', onChange)
  }

  read(): string {
    const value = this.input.value.trim()
    if (this.pattern.test(value)) return value
    throw refusal(this.name, value, this.expected)
  }
}

export type AnyField = NumberField | ChoiceField<string> | TextField

/** The error of a form's field. */
export function refusal(field: string, value: unknown, expected: string): DiffractionError {
  return new DiffractionError({ file: OWNER, field, value, expected })
}

/**
 * What a form makes of its fields; each that is refused says so, and then there is nothing.
 *
 * @param read - reads the fields, and throws a DiffractionError that names one
 */
export function readForm<T>(fields: readonly AnyField[], read: () => T): T | null {
  let isGood = true
  for (const field of fields) {
    try {
      field.read()
      field.refuse(null)
    } catch (error) {
      showRefusal(fields, error)
      isGood = false
    }
  }
  if (!isGood) return null
  try {
    return read()
  } catch (error) {
    showRefusal(fields, error)
    return null
  }
}

/** Says an error beside its field; throws it again where it is no field's. */
export function showRefusal(fields: readonly AnyField[], error: unknown): void {
  const field = error instanceof DiffractionError && fields.find(({ name }) => name === error.field)
  if (!field) throw error
  field.refuse(error)
}
