/** Has what the check of the API reference must find: nothing here is documented as it should be but `depth`. */
export interface Poor {
  /** How deep, µm. */
  depth: number
  /** How wide. */
  width: number
  silent: string
}

/** Has parameters of which nothing is said, and gives what has none that is named. */
export function poor(length: number, names: readonly string[]): number {
  return length + names.length
}

/** Is the mean. */
export const means: readonly [number, number | null] = [0, null]
