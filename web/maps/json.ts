import { DiffractionError } from '../errors.ts'

/** Reads the fields of a parsed JSON document, and names the one that is not what it should be. */
export class JsonReader {
  constructor(
    private readonly file: string,
    /** Of this place, as in `arrays.efficiency.shape`. */
    readonly path: string,
    readonly value: unknown,
  ) {}

  /** The error this place in the document deserves. */
  refuse(expected: string): DiffractionError {
    return new DiffractionError({
      file: this.file,
      field: this.path === '' ? 'document' : this.path,
      value: this.value,
      expected,
    })
  }

  field(name: string): JsonReader {
    const fields = this.object()
    return new JsonReader(this.file, this.path === '' ? name : `${this.path}.${name}`, fields[name])
  }

  get isMissing(): boolean {
    return this.value === undefined
  }

  object(): Record<string, unknown> {
    if (typeof this.value === 'object' && this.value !== null && !Array.isArray(this.value))
      return this.value as Record<string, unknown>
    throw this.refuse('an object')
  }

  string(): string {
    if (typeof this.value === 'string' && this.value !== '') return this.value
    throw this.refuse('a text that is not empty')
  }

  number(): number {
    if (typeof this.value === 'number' && Number.isFinite(this.value)) return this.value
    throw this.refuse('a finite number')
  }

  count(): number {
    if (Number.isInteger(this.value) && (this.value as number) > 0) return this.value as number
    throw this.refuse('a whole number above 0')
  }

  /** The elements, each as a reader of its own. */
  list(): JsonReader[] {
    if (!Array.isArray(this.value)) throw this.refuse('a list')
    return this.value.map(
      (value: unknown, i) => new JsonReader(this.file, `${this.path}[${i}]`, value),
    )
  }

  oneOf<T extends string>(names: readonly T[]): T {
    const found = names.find((name) => name === this.value)
    if (found !== undefined) return found
    throw this.refuse(`one of ${names.join(', ')}`)
  }
}
