import { DiffractionError } from '../errors.ts'

/** Reads the fields of a parsed JSON document, and names the one that is not what it should be. */
export class JsonReader {
  constructor(
    private readonly file: string,
    private readonly path: string,
    private readonly json: unknown,
  ) {}

  /** The error this place in the document deserves. */
  refuse(expected: string): DiffractionError {
    return new DiffractionError({
      file: this.file,
      field: this.path === '' ? 'document' : this.path,
      value: this.json,
      expected,
    })
  }

  field(name: string): JsonReader {
    const fields = this.object()
    return new JsonReader(this.file, this.path === '' ? name : `${this.path}.${name}`, fields[name])
  }

  get isMissing(): boolean {
    return this.json === undefined
  }

  object(): Record<string, unknown> {
    if (typeof this.json === 'object' && this.json !== null && !Array.isArray(this.json))
      return this.json as Record<string, unknown>
    throw this.refuse('an object')
  }

  string(): string {
    if (typeof this.json === 'string' && this.json !== '') return this.json
    throw this.refuse('a text that is not empty')
  }

  number(): number {
    if (typeof this.json === 'number' && Number.isFinite(this.json)) return this.json
    throw this.refuse('a finite number')
  }

  count(): number {
    if (Number.isInteger(this.json) && (this.json as number) > 0) return this.json as number
    throw this.refuse('a whole number above 0')
  }

  /** The elements, each as a reader of its own. */
  list(): JsonReader[] {
    if (!Array.isArray(this.json)) throw this.refuse('a list')
    return this.json.map(
      (value: unknown, i) => new JsonReader(this.file, `${this.path}[${i}]`, value),
    )
  }

  oneOf<T extends string>(names: readonly T[]): T {
    const found = names.find((name) => name === this.json)
    if (found !== undefined) return found
    throw this.refuse(`one of ${names.join(', ')}`)
  }
}
