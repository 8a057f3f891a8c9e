/** Ways to damage JSON and bytes, drawn from a seeded generator; what maps and glTF files are tested with. */

export type Json = Record<string, unknown>
export type Random = () => number

/** Marsaglia's xorshift, 0 to 1. */
export function randomOf(seed: number): Random {
  let state = seed * 2654435761 + 1
  const next = (): number => {
    state ^= state << 13
    state ^= state >>> 17
    state ^= state << 5
    return (state >>> 0) / 2 ** 32
  }
  for (let i = 0; i < 5; i++) next()
  return next
}

export const below = (random: Random, count: number): number => Math.floor(random() * count)
export const pick = <T>(random: Random, list: readonly T[]): T => list[below(random, list.length)]!

/** In text, for JSON.stringify would not nest so far. */
export const DEEP = 'deep'
/** 1e999, which JSON.stringify would not write. */
const HUGE = 'huge'

/** Values that no field has, or few. */
export const HOSTILE: unknown[] = [
  ...[null, true, -1, 0, 1, 1.5, 1e308, -1e308, HUGE, 2 ** 31, 2 ** 53, 2 ** 64, DEEP],
  ...['', '1', 'NaN', 'x'.repeat(10_000), [], {}, [[]], [0, 1], [1e308, 1e308]],
  ...[JSON.parse('{"__proto__": {"file": "x.bin"}}') as unknown, { constructor: 1 }, { '../x': 1 }],
]

/** As text, with what only a text can say. */
export function textOf(json: Json): string {
  return JSON.stringify(json)
    .replaceAll(`"${DEEP}"`, '['.repeat(20_000) + ']'.repeat(20_000))
    .replaceAll(`"${HUGE}"`, '1e999')
}

/** Bytes flipped, cut, left out, put in, or overwritten with bytes of others. */
export function damagedBytes(
  whole: Uint8Array,
  others: readonly Uint8Array[],
  random: Random,
): Uint8Array {
  const bytes = Array.from(whole)
  const at = below(random, bytes.length)
  const length = 1 + below(random, 40)
  const other = Array.from(pick(random, others))
  switch (below(random, 5)) {
    case 0:
      for (let i = below(random, 3); i >= 0; i--)
        bytes[below(random, bytes.length)]! ^= 1 << below(random, 8)
      break
    case 1:
      bytes.length = at
      break
    case 2:
      bytes.splice(at, length)
      break
    case 3:
      bytes.splice(at, 0, ...Array.from({ length }, () => below(random, 256)))
      break
    default:
      bytes.splice(at, length, ...other.slice(at, at + length))
  }
  return Uint8Array.from(bytes)
}

/** Leaves out a field or two somewhere, moves them to another name, or gives them a hostile value. */
export function damageFields(json: Json, hostile: readonly unknown[], random: Random): void {
  for (let i = below(random, 2); i >= 0; i--) {
    let place = json
    let key = pick(random, Object.keys(place))
    while (typeof place[key] === 'object' && place[key] !== null && random() < 0.8) {
      const inner = place[key] as Json
      const keys = Object.keys(inner)
      if (keys.length === 0) break
      place = inner
      key = pick(random, keys)
    }
    const value = structuredClone(pick(random, hostile))
    const action = below(random, 6)
    if (action === 0) Reflect.deleteProperty(place, key)
    else if (action === 1)
      Object.defineProperty(place, typeof value === 'string' ? value : '__proto__', {
        value: place[key],
        enumerable: true,
        configurable: true,
        writable: true,
      })
    else place[key] = value
  }
}
