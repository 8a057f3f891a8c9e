/** How a control reads and changes one property of what may not be there: then there is nothing to set. */
export function property<T extends object, K extends keyof T>(
  owner: () => T | undefined,
  name: K,
): { get: () => T[K] | undefined; set: (value: T[K]) => void } {
  return {
    get: () => owner()?.[name],
    set: (value) => {
      const present = owner()
      if (present !== undefined) present[name] = value
    },
  }
}
