export type DefineValue = string | number | boolean

/**
 * The defines of a program. three knows a program by the names and values of its defines in their order, so those that
 * are out are not among them, and the others are sorted: whatever came in between, a class of scene that was drawn before
 * finds its program.
 */
export class Defines {
  /** Sorted by name; replaced on change, never edited. */
  values: Record<string, string | number> = {}

  /** @param onChange - told of each change, after it */
  constructor(private readonly onChange: (values: Record<string, string | number>) => void) {}

  /** Takes one in, by its value or (true) without one, or leaves it out (false). */
  set(name: string, value: DefineValue): void {
    const define = value === true ? '' : value
    if ((this.values[name] ?? false) === define) return
    const included = Object.entries({ ...this.values, [name]: define }).filter(
      (entry): entry is [string, string | number] => entry[1] !== false,
    )
    this.values = Object.fromEntries(included.sort(([a], [b]) => (a < b ? -1 : 1)))
    this.onChange(this.values)
  }

  setAll(defines: Record<string, DefineValue>): void {
    for (const [name, value] of Object.entries(defines)) this.set(name, value)
  }
}
