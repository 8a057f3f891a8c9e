import { DiffractionError } from '../../web'
import { make, uniqueId } from '../ui/elements'
import { readNumber, readWord, refusal, type NumberRange, type Texts } from './values'

export interface NumberFieldOptions extends NumberRange {
  /** As in the recipe, and in errors. */
  name: string
  label: string
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

  get text(): string {
    return this.input.value
  }

  set text(text: string) {
    this.input.value = text
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
    return readNumber(this.name, this.text, this.#options)
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
    return readWord(this.name, this.text, this.#options)
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
    const value = this.text.trim()
    if (this.pattern.test(value)) return value
    throw refusal(this.name, value, this.expected)
  }
}

export type AnyField = NumberField | ChoiceField<string> | TextField

/**
 * What a form makes of its fields; each that is refused says so, and then there is nothing.
 *
 * @param read - of their texts by name; throws a DiffractionError that names one
 */
export function readForm<T>(fields: readonly AnyField[], read: (texts: Texts) => T): T | null {
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
    return read(Object.fromEntries(fields.map(({ name, text }) => [name, text])))
  } catch (error) {
    showRefusal(fields, error)
    return null
  }
}

/** Writes texts into the fields of their names. */
export function fillForm(fields: readonly AnyField[], texts: Texts): void {
  for (const field of fields) field.text = texts[field.name] ?? field.text
}

/** Says an error beside its field; throws it again where it is no field's. */
export function showRefusal(fields: readonly AnyField[], error: unknown): void {
  const field = error instanceof DiffractionError && fields.find(({ name }) => name === error.field)
  if (!field) throw error
  field.refuse(error)
}
