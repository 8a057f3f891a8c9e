import { DataUtils } from 'three'
import { refuse } from '../errors.ts'
import { readAtMost } from './streams.ts'
import {
  bytesOf,
  MAX_SIDECAR_BYTES,
  readSidecar,
  type ArrayFile,
  type ArraySpec,
  type MapKind,
  type Sidecar,
} from './sidecar.ts'

/** One array of a map, as it is stored: half floats stay 16-bit words. */
export interface MapArray {
  /** What its axes and channels are, and how its texels are decoded. */
  spec: ArraySpec
  /**
   * Half floats as words, floats, or texels of 8 bits, of the quantity and unit that the sidecar names; {@link
   * valuesOf} makes numbers of them.
   */
  data: Uint16Array | Float32Array | Uint8Array
}

/** A map whose every field, length and checksum has been looked at. */
export interface LoadedMap {
  /** The address it came from, without extension. */
  url: string
  /** What its JSON says: kind, quantity, axes with their units, constants, recipe. */
  sidecar: Sidecar
  /** Its numbers, by the sidecar's names. */
  arrays: Record<string, MapArray>
  /** Whether the SHA-256 sums were compared: browsers offer them in secure contexts only. */
  verified: boolean
}

/**
 * Loads and checks a map. Throws a DiffractionError that names file and field of what is wrong.
 *
 * @param url - its address without extension, as in `maps/baked/profile-sinusoidal`
 */
export async function loadMap(url: string): Promise<LoadedMap> {
  const file = `${url}.json`
  const sidecar = readSidecar(file, await fetchJson(file))
  const folder = url.slice(0, url.lastIndexOf('/') + 1)
  const arrays: Record<string, MapArray> = {}
  await Promise.all(
    Object.entries(sidecar.arrays).map(async ([name, spec]) => {
      // Encoded, for a name is no address: % ? # and dots mean themselves.
      const address = folder + encodeURIComponent(spec.file)
      arrays[name] = await readArray(address, spec, (most) => fetchBytes(address, most))
    }),
  )
  return { url, sidecar, arrays, verified: canDigest() }
}

/** Refuses a map of another kind than the one that is needed. */
export function expectKind(map: LoadedMap, kind: MapKind): LoadedMap {
  if (map.sidecar.kind === kind) return map
  refuse(`${map.url}.json`, 'kind', map.sidecar.kind, kind)
}

/**
 * The maps that a surface asked for, each of its kind.
 *
 * @param owner - who asked, for the error
 */
export function expectKinds<T extends Record<string, MapKind>>(
  owner: string,
  maps: Record<string, LoadedMap>,
  kinds: T,
): Record<keyof T, LoadedMap> {
  for (const [name, kind] of Object.entries(kinds)) {
    const map = maps[name]
    if (map === undefined) refuse(owner, 'tables', Object.keys(maps), Object.keys(kinds).join(', '))
    expectKind(map, kind)
  }
  return maps as Record<keyof T, LoadedMap>
}

/** The array of that name, which the map's kind promises. */
export function arrayOf(map: LoadedMap, name: string): MapArray {
  const array = map.arrays[name]
  if (array !== undefined) return array
  refuse(`${map.url}.json`, `arrays.${name}`, undefined, 'an array')
}

/** The numbers of a constant, which the map's kind promises. */
export function constantOf(map: LoadedMap, name: string): number[] {
  const constant = map.sidecar.constants[name]
  if (constant !== undefined) return constant
  refuse(`${map.url}.json`, `constants.${name}`, undefined, 'a number or a list of numbers')
}

/**
 * The array's elements as numbers: half floats widened, 8-bit texels decoded channel by channel.
 *
 * @param array - of a map that is loaded
 * @returns in the unit of the sidecar's quantity, which has no unit for efficiencies and colours; slowest axis first, channels last
 */
export function valuesOf({ spec, data }: MapArray): Float32Array {
  if (data instanceof Float32Array) return data
  const { decode, channels } = spec
  // Float32Array.from takes several times as long.
  return new Float32Array(data.length).map((_, i) => {
    const word = data[i]!
    if (data instanceof Uint16Array) return DataUtils.fromHalfFloat(word)
    const [offset, scale] = decode?.[i % channels.length] ?? [0, 1]
    return offset + (scale * word) / 255
  })
}

/**
 * An array as it is stored: a PNG of its size for uint8, else its numbers, little-endian.
 *
 * @param file - for the error
 * @param read - gives no more than so many bytes, in a buffer of their own
 */
export async function readArray(
  file: string,
  spec: ArraySpec & Partial<ArrayFile>,
  read: (most: number) => Promise<Uint8Array>,
): Promise<MapArray> {
  const expected = bytesOf(spec)
  const isImage = spec.dtype === 'uint8'
  // Deflate stores what it cannot compress; twice as much is no picture of that size.
  const bytes = await read(isImage ? 2 * expected + 2 ** 16 : expected)
  // Lengths first: "truncated" says more than a checksum that differs.
  if (!isImage) expectLength(file, bytes, spec, expected)
  const data = isImage ? await decoded(file, bytes, spec) : typedArray(bytes, spec)
  if (spec.sha256 && canDigest()) await checkDigest(file, bytes, spec.sha256)
  checkFinite(file, data)
  return { spec, data }
}

function expectLength(file: string, bytes: Uint8Array, spec: ArraySpec, expected: number): void {
  if (bytes.length === expected) return
  refuse(
    file,
    'bytes',
    bytes.length,
    `${expected}, for ${spec.shape.join(' × ')} of ${spec.dtype} (the file is truncated)`,
  )
}

/** The decoder is a chunk of its own: gratings have no images. */
async function decoded(file: string, bytes: Uint8Array, spec: ArraySpec): Promise<Uint8Array> {
  const { decodePng } = await import('./png.ts')
  return decodePng(file, bytes, spec.shape)
}

/** Little-endian bytes as numbers; every platform with WebGL is little-endian itself. */
function typedArray(bytes: Uint8Array, spec: ArraySpec): MapArray['data'] {
  const buffer = bytes.buffer as ArrayBuffer
  return spec.dtype === 'float16' ? new Uint16Array(buffer) : new Float32Array(buffer)
}

function checkFinite(file: string, data: MapArray['data']): void {
  let count = 0
  if (data instanceof Float32Array) {
    for (const value of data) if (!Number.isFinite(value)) count++
  } else if (data instanceof Uint16Array) {
    // All exponent bits set: an infinity or NaN.
    for (const half of data) if ((half & 0x7c00) === 0x7c00) count++
  }
  if (count > 0) refuse(file, 'values that are NaN or infinite', count, '0')
}

function canDigest(): boolean {
  return (globalThis.crypto as Crypto | undefined)?.subtle !== undefined
}

async function checkDigest(file: string, bytes: Uint8Array, expected: string): Promise<void> {
  const digest = await crypto.subtle.digest('SHA-256', bytes as BufferSource)
  const hex = Array.from(new Uint8Array(digest), (byte) => byte.toString(16).padStart(2, '0'))
  if (hex.join('') !== expected)
    refuse(
      file,
      'SHA-256',
      hex.join(''),
      `${expected}, as in the sidecar (truncated, or of another bake)`,
    )
}

async function fetchJson(file: string): Promise<unknown> {
  const bytes = await fetchBytes(file, MAX_SIDECAR_BYTES)
  try {
    return JSON.parse(
      new TextDecoder('utf-8', { fatal: true, ignoreBOM: true }).decode(bytes),
    ) as unknown
  } catch (cause) {
    refuse(file, 'document', String(cause), 'JSON', cause)
  }
}

/** A file of so many bytes at most; of a longer one no more are read. */
async function fetchBytes(file: string, most: number): Promise<Uint8Array> {
  let response: Response
  let bytes: Uint8Array | undefined
  try {
    response = await fetch(file)
    if (response.ok) bytes = await readAtMost(response.body, most)
  } catch (cause) {
    refuse(file, 'file', String(cause), 'a file that can be fetched', cause)
  }
  if (!response.ok) refuse(file, 'file', `HTTP ${response.status}`, 'a file that is there')
  if (bytes === undefined) refuse(file, 'bytes', `more than ${most}`, `${most} at most`)
  return bytes
}
