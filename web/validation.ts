import { refuse } from './errors.ts'

/** Returns the value if it is finite and above zero; `unit` goes into the error's text. */
export function positive(owner: string, field: string, value: unknown, unit: string): number {
  if (typeof value === 'number' && Number.isFinite(value) && value > 0) return value
  refuse(owner, field, value, `a finite number above 0${suffix(unit)}`)
}

/** Returns the value if it is a finite number, and in [min, max] where these are finite. */
export function within(
  owner: string,
  field: string,
  value: unknown,
  min: number,
  max: number,
  unit = '',
): number {
  if (typeof value === 'number' && Number.isFinite(value) && value >= min && value <= max)
    return value
  const range = max === Infinity ? 'a finite number' : `a number from ${min} to ${max}`
  refuse(owner, field, value, range + suffix(unit))
}

/** Returns the value if it can be the angular radius of a light, rad. A point is said by stating none. */
export function angularRadius(owner: string, field: string, value: unknown): number {
  if (typeof value === 'number' && value > 0 && value <= Math.PI / 2) return value
  refuse(
    owner,
    field,
    value,
    'a number above 0 and up to π/2 (rad), or none for a light that is a point',
  )
}

/** Returns the value if it is one of the names. */
export function oneOf<T extends string>(
  owner: string,
  field: string,
  value: unknown,
  names: readonly T[],
): T {
  const found = names.find((name) => name === value)
  if (found !== undefined) return found
  refuse(owner, field, value, `one of ${names.map((name) => `'${name}'`).join(', ')}`)
}

function suffix(unit: string): string {
  return unit && ` (${unit})`
}
