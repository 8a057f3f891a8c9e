import { MAPPINGS, type Axis } from './axes.ts'
import { JsonReader } from './json.ts'
import { checkContents, MAP_KINDS } from './kinds.ts'

export const MAP_FORMAT = 'three-diffraction/map'
export const MAP_VERSION = 1

/** What a map holds. */
export type MapKind =
  'profile' | 'lobes' | 'metals' | 'foil' | 'height-field-terms' | 'height-field-baked'

/** Shipped sidecars have 16 kB. */
export const MAX_SIDECAR_BYTES = 2 ** 18
/** 8192 × 8192 texels of 8-bit RGBA: larger textures cannot be relied upon. */
const MAX_ARRAY_BYTES = 2 ** 28

export const DTYPES = ['float16', 'float32', 'uint8'] as const
/** How numbers are stored: as halves, as floats, or as bytes of an image. */
export type Dtype = (typeof DTYPES)[number]

const BYTES_PER_ELEMENT: Record<Dtype, number> = { float16: 2, float32: 4, uint8: 1 }

/** One array of a map: slowest axis first, channels last. */
export interface ArraySpec {
  /** How its numbers are stored. */
  dtype: Dtype
  /** Number of elements along each axis, and of channels. */
  shape: number[]
  /** The named axes; an image has none, its rows and columns are the surface itself. */
  axes: Axis[]
  /** What each channel holds. */
  channels: string[]
  /** Images of 8 bits: value = offset + scale · texel/255, one pair a channel; else null. */
  decode: [number, number][] | null
}

/** Where a sidecar has the bytes of an array. */
export interface ArrayFile {
  /** File name beside the sidecar. */
  file: string
  sha256: string
}

/** What a map says of itself; `Place` is where the bytes of its arrays are. */
export interface Sidecar<Place = unknown> {
  /** By which such a file is told from others. */
  format: typeof MAP_FORMAT
  /** Version of the format. */
  version: typeof MAP_VERSION
  /** What the map holds. */
  kind: MapKind
  /** What its numbers are, in words. */
  quantity: string
  /** The quantity's symbol. */
  symbol: string
  /** What is said of each array, by its name. */
  arrays: Record<string, ArraySpec & Place>
  /** Numbers that go with the arrays: lengths in µm (`tile_mm` in mm), angles and phases in rad; a single one is a list of one. */
  constants: Record<string, number[]>
  /** The recipe the map was baked from, as it was given. */
  recipe: Record<string, unknown>
}

/** Size of an array's numbers, before any compression. */
export function bytesOf({ dtype, shape }: Pick<ArraySpec, 'dtype' | 'shape'>): number {
  return shape.reduce((product, size) => product * size, BYTES_PER_ELEMENT[dtype])
}

/** Checks a parsed sidecar field by field; `file` goes into the error. */
export function readSidecar(file: string, json: unknown): Sidecar<ArrayFile> {
  return readMapFields(new JsonReader(file, '', json), readArrayFile)
}

/**
 * Checks what a map says of itself, wherever it says so.
 *
 * @param readPlace - reads from an array's field where its bytes are
 */
export function readMapFields<Place>(
  root: JsonReader,
  readPlace: (field: JsonReader, dtype: Dtype) => Place,
): Sidecar<Place> {
  const format = root.field('format').oneOf([MAP_FORMAT])
  const version = root.field('version')
  if (version.number() !== MAP_VERSION) throw version.refuse(String(MAP_VERSION))
  const kind = root.field('kind').oneOf(MAP_KINDS)

  const arrays: Record<string, ArraySpec & Place> = {}
  const arraysField = root.field('arrays')
  for (const name of Object.keys(arraysField.object())) {
    expectName(arraysField, name)
    const field = arraysField.field(name)
    const dtype = field.field('dtype').oneOf(DTYPES)
    arrays[name] = { ...readPlace(field, dtype), ...readArray(field, dtype) }
  }

  const constantsField = root.field('constants')
  const constants = readConstants(constantsField)
  checkContents(kind, arraysField, arrays, constantsField, constants)

  return {
    format,
    version: MAP_VERSION,
    kind,
    quantity: root.field('quantity').string(),
    symbol: root.field('symbol').string(),
    arrays,
    constants,
    recipe: root.field('recipe').isMissing ? {} : root.field('recipe').object(),
  }
}

/** Names become keys of objects, where `__proto__` would be none. */
function expectName(field: JsonReader, name: string): void {
  if (!/^[A-Za-z][A-Za-z0-9_]*$/.test(name))
    throw field.field(name).refuse('a name of letters, digits and _')
}

function readArrayFile(field: JsonReader, dtype: Dtype): ArrayFile {
  const fileField = field.field('file')
  const file = fileField.string()
  // A sidecar names its neighbours, nothing above or elsewhere; lone surrogates are in no address.
  if (!/^[^/\\:\p{Cc}\p{Cs}]+\.(bin|png)$/u.test(file))
    throw fileField.refuse("a .bin's or .png's name without a folder")
  const isImage = file.endsWith('.png')
  if (isImage !== (dtype === 'uint8'))
    throw field
      .field('dtype')
      .refuse(isImage ? 'uint8 for a .png' : 'float16 or float32 for a .bin')

  const shaField = field.field('sha256')
  const sha256 = shaField.string()
  if (!/^[0-9a-f]{64}$/.test(sha256)) throw shaField.refuse('64 lower-case hexadecimal digits')
  return { file, sha256 }
}

function readArray(field: JsonReader, dtype: Dtype): ArraySpec {
  const isImage = dtype === 'uint8'

  const shapeField = field.field('shape')
  const shape = shapeField.list().map((size) => size.count())
  if (shape.length < 2 || shape.length > 4)
    throw shapeField.refuse('2 to 4 sizes, the number of channels last')
  if (isImage && (shape.length !== 3 || shape[2] !== 4))
    throw shapeField.refuse('rows, columns and 4 channels for uint8')
  if (bytesOf({ dtype, shape }) > MAX_ARRAY_BYTES)
    throw shapeField.refuse(`an array of ${MAX_ARRAY_BYTES} bytes at most`)

  const channelsField = field.field('channels')
  const channels = channelsField.list().map((channel) => channel.string())
  if (channels.length !== shape.at(-1))
    throw channelsField.refuse(`${String(shape.at(-1))} names, one for each channel of the shape`)

  const axesField = field.field('axes')
  const axisFields = axesField.isMissing ? [] : axesField.list()
  const axes = axisFields.map(readAxis)
  if (axes.length !== 0 && axes.length !== shape.length - 1)
    throw axesField.refuse(`${shape.length - 1} axes, one for each size of the shape but the last`)
  for (const [i, axisField] of axisFields.entries()) {
    const sizeField = axisField.field('size')
    if (axes[i]?.size !== shape[i]) throw sizeField.refuse(`${String(shape[i])}, as in the shape`)
  }

  const decodeField = field.field('decode')
  const decode = isImage ? readDecode(decodeField, channels.length) : null
  if (!isImage && !decodeField.isMissing) throw decodeField.refuse('none but for uint8')

  return { dtype, shape, axes, channels, decode }
}

function readAxis(field: JsonReader): Axis {
  const axis: Axis = {
    name: field.field('name').string(),
    symbol: field.field('symbol').string(),
    unit: field.field('unit').string(),
    size: field.field('size').count(),
    mapping: field.field('mapping').oneOf(MAPPINGS),
    first: field.field('first').number(),
    last: field.field('last').number(),
  }
  if (axis.size > 1 && axis.last === axis.first)
    throw field.field('last').refuse(`something other than first, ${axis.first}`)
  if (axis.mapping === 'log' && !(axis.first > 0 && axis.last > 0))
    throw field.field('first').refuse('ends above 0 on a logarithmic axis')
  return axis
}

function readDecode(field: JsonReader, channels: number): [number, number][] {
  const pairs = field.list()
  if (pairs.length !== channels)
    throw field.refuse(`${channels} pairs of offset and scale, one a channel`)
  return pairs.map((pair) => {
    const [offset, scale, ...rest] = pair.list()
    if (offset === undefined || scale === undefined || rest.length > 0)
      throw pair.refuse('a pair of offset and scale')
    const ends = [offset.number(), offset.number() + scale.number()]
    // Decoded to single precision.
    if (!ends.every((end) => Number.isFinite(Math.fround(end))))
      throw pair.refuse('values below 3.4e38')
    return [offset.number(), scale.number()]
  })
}

function readConstants(field: JsonReader): Record<string, number[]> {
  const constants: Record<string, number[]> = {}
  for (const [name, value] of Object.entries(field.object())) {
    expectName(field, name)
    const entry = field.field(name)
    constants[name] = Array.isArray(value) ? entry.list().map((v) => v.number()) : [entry.number()]
  }
  return constants
}
