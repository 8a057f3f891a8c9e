import { DiffractionError } from '../errors.ts'

/** Where in a glTF file the values stand that our classes and maps refuse under names of their own. */
export class FilePlaces {
  readonly #owners = new Map<string, string>()
  readonly #fields = new Map<string, string>()

  /**
   * @param file - the glTF file's name, for errors
   * @param parent - places that are known besides
   */
  constructor(
    readonly file: string,
    private readonly parent: FilePlaces | null = null,
  ) {}

  /** What errors call `owner` stands at that path in the file. */
  add(owner: string, path: string): void {
    this.#owners.set(owner, path)
  }

  /** Likewise of one field of it. */
  addField(owner: string, field: string, path: string): void {
    this.#fields.set(`${owner}: ${field}`, path)
  }

  /** The error as one of the file, where its value came from there. */
  errorOf(error: DiffractionError): DiffractionError {
    const owner = this.#owners.get(error.file)
    const field =
      this.#fields.get(`${error.file}: ${error.field}`) ?? (owner && `${owner}.${error.field}`)
    if (field === undefined) return this.parent?.errorOf(error) ?? error
    const { value, expected } = error
    return new DiffractionError({ file: this.file, field, value, expected }, { cause: error })
  }
}
