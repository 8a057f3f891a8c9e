import { DiffractionError } from '../../web'
import { encodePng } from '../../web/gltf/encode-png'
import {
  arrayOf,
  constantOf,
  readArray,
  valuesOf,
  type LoadedMap,
  type MapArray,
} from '../../web/maps/load'
import { MAP_FORMAT, MAP_VERSION, readSidecar, type ArraySpec } from '../../web/maps/sidecar'
import { roundHalfEven } from '../numbers/round-half-even'
import type { Work } from './work'

/** A foil's texels: cos 2θ, sin 2θ, 1/a (1/µm) and strength of each, rows from the top. */
export interface FoilTexels {
  rows: number
  columns: number
  values: Float64Array
}

/** What a map says beside its texels. */
export interface FoilFacts {
  /** µm */
  height: number
  /** Width and height of the tile, mm. */
  tile: readonly [number, number]
  recipe: Record<string, unknown>
  /** Further arrays, such as bumps, as another map stores them. */
  others?: Record<string, MapArray>
}

/** A map as files, by their names, the sidecar among them; and as the library reads it. */
export interface MadeFoil {
  name: string
  files: Record<string, Uint8Array<ArrayBuffer>>
  map: LoadedMap
}

const CHANNELS = ['cos 2theta', 'sin 2theta', 'spatial frequency', 'strength']

/** The texels of a foil's map in double precision, as `precompute.maps` decodes them, row by row. */
export function* texelsOf(map: LoadedMap): Work<FoilTexels> {
  const array = arrayOf(map, 'grating')
  const { spec, data } = array
  const [rows, columns] = spec.shape as [number, number]
  const values = new Float64Array(data.length)
  const stride = 4 * columns
  for (let at = 0; at < data.length; at += stride) {
    yield at / data.length
    const row = data.subarray(at, at + stride)
    if (spec.decode === null) {
      values.set(valuesOf({ spec, data: row }), at)
      continue
    }
    for (let i = 0; i < stride; i++) {
      const [offset, scale] = spec.decode[i % 4]!
      values[at + i] = offset + (scale * row[i]!) / 255
    }
  }
  return { rows, columns, values }
}

/** Texels in 8 bits a channel, and what is said of them: `precompute.foils.foil_map.map_of_texels`. */
export interface StoredFoil {
  rows: number
  columns: number
  bytes: Uint8Array
  decode: [number, number][]
  minFrequency: number
  maxFrequency: number
  /** Root mean square of the rounding over that of the values. */
  error: number
}

/** Row by row. Throws a DiffractionError where nothing diffracts. */
export function* stored({ rows, columns, values }: FoilTexels): Work<StoredFoil> {
  const [bytes, count] = [new Uint8Array(values.length), 4 * columns]
  let [top, least, most] = [0, Infinity, 0]
  for (let i = 2; i < values.length; i += 4) {
    if (i % count === 2) yield (0.2 * i) / values.length
    const frequency = values[i]!
    top = Math.max(top, frequency)
    if (values[i + 1]! <= 0) continue
    least = Math.min(least, frequency)
    most = Math.max(most, frequency)
  }
  if (most === 0)
    throw new DiffractionError({
      file: 'foil map',
      field: 'strength',
      value: 0,
      expected: 'above 0 somewhere',
    })
  const decode: [number, number][] = [
    [-1, 2],
    [-1, 2],
    [0, top],
    [0, 1],
  ]
  let [off, total] = [0, 0]
  for (let row = 0; row < rows; row++) {
    yield 0.2 + (0.8 * row) / rows
    for (let i = row * count; i < (row + 1) * count; i++) {
      const [offset, scale] = decode[i % 4]!
      const value = values[i]!
      const texel = roundHalfEven(((value - offset) / scale) * 255)
      bytes[i] = texel
      off += (offset + (scale * texel) / 255 - value) ** 2
      total += value ** 2
    }
  }
  const error = Math.sqrt(off / total)
  return { rows, columns, bytes, decode, minFrequency: least, maxFrequency: most, error }
}

/**
 * The files of a map, read again by the library's own reader.
 *
 * @param name - of the files, without extension
 */
export async function madeFoil(
  name: string,
  foil: StoredFoil,
  { height, tile, recipe, others = {} }: FoilFacts,
): Promise<MadeFoil> {
  const { rows, columns } = foil
  const files: MadeFoil['files'] = {}
  const arrays: Record<string, object> = {}
  const grating: ArraySpec = {
    ...{ dtype: 'uint8', shape: [rows, columns, 4], channels: CHANNELS, decode: foil.decode },
    axes: [axis('row', '1-v', rows), axis('column', 'u', columns)],
  }
  const all: Record<string, MapArray> = { grating: { spec: grating, data: foil.bytes }, ...others }
  for (const [key, { spec, data }] of Object.entries(all)) {
    const bytes =
      data instanceof Uint8Array
        ? await encodePng(data, spec.shape as [number, number])
        : new Uint8Array(data.slice().buffer)
    const file = `${name}.${key}.${data instanceof Uint8Array ? 'png' : 'bin'}`
    files[file] = bytes
    const { dtype, shape, axes, channels, decode } = spec
    arrays[key] = {
      ...{ file, dtype, shape, sha256: await sha256(bytes), axes, channels },
      ...(decode !== null && { decode }),
    }
  }
  const sidecar = {
    ...{ format: MAP_FORMAT, version: MAP_VERSION, kind: 'foil' },
    ...{ quantity: 'grating at each point of a foil', symbol: '(theta, 1/a, strength)', arrays },
    constants: {
      height_um: height,
      min_frequency: foil.minFrequency,
      max_frequency: foil.maxFrequency,
      tile_mm: tile,
    },
    error: { relative_rms: foil.error, against: 'the map before 8-bit rounding' },
    recipe,
    generator: { name: 'three-diffraction demo' },
  }
  files[`${name}.json`] = new TextEncoder().encode(`${JSON.stringify(sidecar, null, 1)}\n`)
  return { name, files, map: await readAgain(name, sidecar, files) }
}

async function readAgain(
  name: string,
  json: unknown,
  files: MadeFoil['files'],
): Promise<LoadedMap> {
  const sidecar = readSidecar(`${name}.json`, json)
  const arrays: Record<string, MapArray> = {}
  for (const [key, spec] of Object.entries(sidecar.arrays))
    // A copy, as if it had been fetched.
    arrays[key] = await readArray(spec.file, spec, () => Promise.resolve(files[spec.file]!.slice()))
  return { url: name, sidecar, arrays, verified: true }
}

function axis(name: string, symbol: string, size: number): ArraySpec['axes'][number] {
  return { name, symbol, unit: '1', size, mapping: 'linear', first: 0, last: 1 }
}

async function sha256(bytes: BufferSource): Promise<string> {
  // Browsers offer it in secure contexts only.
  if ((crypto as Partial<Crypto>).subtle === undefined)
    throw new DiffractionError({
      ...{ file: 'page', field: 'address', value: location.origin },
      expected: 'https or localhost: elsewhere browsers compute no checksums',
    })
  const digest = new Uint8Array(await crypto.subtle.digest('SHA-256', bytes))
  return Array.from(digest, (byte) => byte.toString(16).padStart(2, '0')).join('')
}

/** What an edit keeps of a map: all but its texels and recipe. */
export function factsOf(map: LoadedMap): Omit<FoilFacts, 'recipe'> {
  const [width, height] = constantOf(map, 'tile_mm') as [number, number]
  const others = Object.fromEntries(
    Object.entries(map.arrays).filter(([name]) => name !== 'grating'),
  )
  return { height: constantOf(map, 'height_um')[0]!, tile: [width, height], others }
}
