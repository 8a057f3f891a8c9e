import { DiffractionError } from '../../web'

/** A value of the page that its address can state, as text. */
export interface Setting {
  /** Its name in the address. */
  name: string
  /** The value as it is; undefined where it has no meaning. */
  read: () => string | undefined
  /** Takes a value over; throws a DiffractionError where it is none that `read` could have given. */
  write: (text: string) => void | Promise<void>
}

/** Where a value that is refused came from. */
export const ADDRESS = 'address'

interface Value<T> {
  get: () => T | undefined
  set: (value: T) => void | Promise<void>
}

/** A number between bounds, both included. */
export function numberSetting(
  name: string,
  { min, max, get, set }: Value<number> & { min: number; max: number },
): Setting {
  return {
    name,
    read: () => get()?.toString(),
    write: (text) => {
      const value = Number(text)
      if (text.trim() === '' || !(value >= min && value <= max))
        throw new DiffractionError({
          file: ADDRESS,
          field: name,
          value: text,
          expected: `a number from ${min} to ${max}`,
        })
      return set(value)
    },
  }
}

/** One of some words. */
export function choiceSetting<T extends string>(
  name: string,
  { words, get, set }: Value<T> & { words: () => readonly T[] },
): Setting {
  return {
    name,
    read: get,
    write: (text) => {
      const word = words().find((candidate) => candidate === text)
      if (word === undefined)
        throw new DiffractionError({
          file: ADDRESS,
          field: name,
          value: text,
          expected: `one of ${words().join(', ')}`,
        })
      return set(word)
    },
  }
}
