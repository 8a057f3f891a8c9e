/** A module in a chunk of its own, which scenes that do not need it never fetch. */
export class LazyCode<Code> {
  /** Null before it has come. */
  code: Code | null = null

  constructor(private readonly fetch: () => Promise<Code>) {}

  /** Rejects where the chunk cannot be fetched; it is tried anew the next time. */
  async load(): Promise<void> {
    this.code ??= await this.fetch()
  }
}

/** What rough gratings read of an environment. */
export const roughEnvironment = new LazyCode(() => import('./environment/rough-environment.ts'))

/** Choices by what the report has measured, for materials with a `maxError`. */
export const errorChoice = new LazyCode(() => import('./materials/error-choice.ts'))
