import type { JsonReader } from '../maps/json.ts'

/** Name of the extension: docs/gltf/README.md. */
export const EXTENSION = 'TDIFF_materials_diffraction'

/** A field of the extension that is a property of ours by the same name. */
interface Field {
  read: (reader: JsonReader) => unknown
  /** What is left out of files: the property's value where nothing is given. Without it the field is always written. */
  initial?: unknown
}
export type Fields = Readonly<Record<string, Field>>

const text = (reader: JsonReader): string => reader.string()
const number = (reader: JsonReader): number => reader.number()
const count = (reader: JsonReader): number => reader.count()

function truth(reader: JsonReader): boolean {
  if (typeof reader.value === 'boolean') return reader.value
  throw reader.refuse('true or false')
}

/** So many finite numbers. */
export function numbers(reader: JsonReader, length: number): number[] {
  const items = reader.list()
  if (items.length !== length) throw reader.refuse(`${length} numbers`)
  return items.map(number)
}

const pair = (reader: JsonReader): number[] => numbers(reader, 2)

/** Fields of a surface of each kind, but for its maps. */
export const SURFACE_FIELDS = {
  grating: {
    period: { read: number },
    height: { read: number },
    orientation: { read: number, initial: 0 },
    tracks: { read: text, initial: 'straight' },
    strength: { read: number, initial: 1 },
  },
  foil: {
    height: { read: number },
    repeat: { read: pair, initial: [1, 1] },
    filtered: { read: truth, initial: true },
  },
  heightField: {
    orientation: { read: number, initial: 0 },
    strength: { read: number, initial: 1 },
    ior: { read: number, initial: null },
    tiles: { read: pair, initial: null },
  },
} satisfies Record<string, Fields>
export type SurfaceKind = keyof typeof SURFACE_FIELDS

/** Methods that a height field has maps of their own for; the lines of 'line-sum' come from that of 'jacobi-anger'. */
export const FIELD_MAPS = ['jacobi-anger', 'taylor', 'baked'] as const

/** Fields of the material, but for its tables and its matt base. */
export const MATERIAL_FIELDS = {
  metal: { read: text },
  observer: { read: text },
  roughness: { read: number },
  coherence: { read: number },
  lightAngularRadius: { read: number, initial: null },
  coat: { read: number, initial: 0 },
  coatIor: { read: number, initial: 1.5 },
  coatRoughness: { read: number, initial: 0 },
} satisfies Fields

/** What is only written where it was given: else the surface has its own. */
export const GIVEN_FIELDS = { energy: { read: text } } satisfies Fields

/** How it is drawn, but for what a largest error may choose. */
export const RENDERING_FIELDS = {
  maxError: { read: number, initial: null },
  planarEnvironment: { read: truth, initial: true },
  gamut: { read: text, initial: 'map' },
  diffraction: { read: truth, initial: true },
} satisfies Fields

/** Likewise: the rest is the default's or `maxError`'s. */
export const CHOSEN_FIELDS = {
  method: { read: text },
  efficiencies: { read: text },
  wavelengthStep: { read: number },
  environmentNodes: { read: count },
} satisfies Fields

/** Refuses fields that are none of these, by name; `extras` and `extensions` may stand anywhere in a glTF. */
export function expectOnly(reader: JsonReader, names: readonly string[]): void {
  for (const name of Object.keys(reader.object()))
    if (!names.includes(name) && name !== 'extras' && name !== 'extensions')
      throw reader.field(name).refuse(`none of that name; there are ${names.join(', ')}`)
}

/** The fields that are there. */
export function readFields(reader: JsonReader, fields: Fields): Record<string, unknown> {
  const given = Object.entries(fields).filter(([name]) => !reader.field(name).isMissing)
  return Object.fromEntries(given.map(([name, { read }]) => [name, read(reader.field(name))]))
}

/** The properties that are not as a reader finds them anyway. */
export function writeFields(source: object, fields: Fields): Record<string, unknown> {
  const values = Object.entries(fields).map(([name, { initial }]) => ({
    name,
    initial,
    value: jsonOf(source[name as keyof typeof source]),
  }))
  const written = values.filter(
    ({ value, initial }) => JSON.stringify(value) !== JSON.stringify(initial),
  )
  return Object.fromEntries(written.map(({ name, value }) => [name, value]))
}

/** Vectors of three as lists. */
function jsonOf(value: unknown): unknown {
  const isVector = typeof value === 'object' && value !== null && 'toArray' in value
  return isVector ? (value as { toArray: () => number[] }).toArray() : value
}
