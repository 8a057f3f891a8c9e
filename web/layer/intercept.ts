/**
 * Runs a function of ours around a method of one object, whichever method is set there now or later.
 *
 * Who sets a method that calls the one it found there, as is usual with `onBeforeCompile`, found ours: called from within
 * itself ours stands for the method that was set before.
 *
 * @param around - called with what is set at the time
 * @returns takes ours away; what was set by others stays
 */
export function intercept<Args extends unknown[], Result>(
  object: object,
  name: string,
  around: (next: (...args: Args) => Result, ...args: Args) => Result,
): () => void {
  type Method = (...args: Args) => Result
  const methods = object as Record<string, Method>
  const before = Object.getOwnPropertyDescriptor(object, name)
  const given = [methods[name]!]
  let depth = 0
  let isRemoved = false

  const ours = (...args: Args): Result => {
    const at = Math.max(given.length - 1 - depth - (isRemoved ? 1 : 0), 0)
    const next: Method = (...all) => given[at]!.apply(object, all)
    depth++
    try {
      return depth === 1 && !isRemoved ? around(next, ...args) : next(...args)
    } finally {
      depth--
    }
  }
  // three's default cache key is the text of a hook: two of others' must not look alike.
  ours.toString = () => String(given.at(-1))

  Object.defineProperty(object, name, {
    configurable: true,
    enumerable: true,
    get: () => ours,
    set: (value: Method) => {
      if (value !== ours && value !== given.at(-1)) given.push(value)
    },
  })
  return () => {
    isRemoved = true
    Reflect.deleteProperty(object, name)
    if (given.length > 1) methods[name] = given.at(-1)!
    else if (before !== undefined) Object.defineProperty(object, name, before)
  }
}
