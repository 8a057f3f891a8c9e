/** What was wrong with an input: where it stood, what it was, what it should have been. */
export interface DiffractionErrorDetails {
  /** The file the value came from, or the name of the class or option it was given to. */
  file: string
  /** The field's path inside it, as in `arrays.efficiency.shape`. */
  field: string
  /** The value that was refused. */
  value: unknown
  /** What would have been accepted. */
  expected: string
}

/** The one error that bad input raises, whether it is a map, an option or a light. */
export class DiffractionError extends Error {
  /** Tells it from other errors where `instanceof` cannot, as between two copies of the package. */
  override readonly name = 'DiffractionError'
  /** The file the value came from, or the name of the class or option it was given to. */
  readonly file: string
  /** The field's path inside it. */
  readonly field: string
  /** The value that was refused. */
  readonly value: unknown
  /** What would have been accepted. */
  readonly expected: string

  /** @param options - `cause`, where another error led to this one. */
  constructor({ file, field, value, expected }: DiffractionErrorDetails, options?: ErrorOptions) {
    super(`${file}: ${field} is ${describe(value)}, expected ${expected}`, options)
    this.file = file
    this.field = field
    this.value = value
    this.expected = expected
  }
}

/**
 * Throws the error that a value deserves.
 *
 * @param cause - another error that led to it
 */
export function refuse(
  file: string,
  field: string,
  value: unknown,
  expected: string,
  cause?: unknown,
): never {
  throw new DiffractionError({ file, field, value, expected }, cause === undefined ? {} : { cause })
}

/** Short enough for one line of a console, and true for NaN and infinities, which JSON turns to null. */
function describe(value: unknown): string {
  if (value === undefined) return 'missing'
  if (typeof value === 'number' || typeof value === 'bigint') return String(value)
  if (typeof value === 'function') return 'a function'
  let text: string | undefined
  try {
    text = JSON.stringify(value)
  } catch {
    // Nested too deep, or within itself.
  }
  if (text === undefined) return typeof value
  return text.length > 80 ? `${text.slice(0, 77)}…` : text
}
