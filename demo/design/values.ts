import { DiffractionError } from '../../web'
import { within } from '../../web/validation'

const OWNER = 'design'

/** Values by name, as text: what fields hold and addresses state. */
export type Texts = Readonly<Record<string, string | undefined>>

export interface NumberRange {
  unit: string
  min: number
  max: number
  isWhole?: boolean
}

/** A number of that name; throws a DiffractionError where the text is none in the range. */
export function readNumber(name: string, text: string | undefined, range: NumberRange): number {
  const { min, max, unit, isWhole } = range
  // Either mark of decimals is typed.
  const trimmed = text?.trim().replace(',', '.') ?? ''
  const value = trimmed === '' ? NaN : Number(trimmed)
  within(OWNER, name, value, min, max, unit)
  if (isWhole && !Number.isInteger(value))
    throw refusal(name, value, `a whole number from ${min} to ${max}`)
  return value
}

/** One of some words; throws a DiffractionError where the text is none of them. */
export function readWord<T extends string>(
  name: string,
  text: string | undefined,
  words: Readonly<Record<T, string>>,
): T {
  const names = Object.keys(words) as T[]
  const found = names.find((word) => word === text)
  if (found !== undefined) return found
  throw refusal(name, text, `one of ${names.join(', ')}`)
}

/** The error of a value by its name. */
export function refusal(field: string, value: unknown, expected: string): DiffractionError {
  return new DiffractionError({ file: OWNER, field, value, expected })
}
