import type { GLTFParser } from 'three/addons/loaders/GLTFLoader.js'
import { refuse } from '../errors.ts'
import { loadSharedMap } from '../maps/cache.ts'
import { JsonReader } from '../maps/json.ts'
import { expectKind, readArray, type LoadedMap } from '../maps/load.ts'
import { bytesOf, readMapFields, type MapKind, type Sidecar } from '../maps/sidecar.ts'
import { EXTENSION, expectOnly } from './fields.ts'
import type { FilePlaces } from './file-places.ts'
import { expectSound } from './sound-map.ts'

const MAP_FIELDS = [
  ...['format', 'version', 'kind', 'quantity', 'symbol', 'arrays', 'constants', 'recipe'],
  // Of no use here, but they stand in sidecars.
  ...['error', 'generator'],
]
const ARRAY_FIELDS = ['bufferView', 'dtype', 'shape', 'axes', 'channels', 'decode']
const AXIS_FIELDS = ['name', 'symbol', 'unit', 'size', 'mapping', 'first', 'last']

/**
 * A path from the file to a sidecar, as RFC 3986 has it: no scheme, host or root, no query or fragment. Backslashes are
 * slashes to browsers, which also read over control characters in a scheme.
 */
const RELATIVE_PATH = /^(?!\/)[^\\:?#\p{Cc}\p{Cs}]+\.json$/u

/** Where the bytes of an array are. */
interface ArrayView {
  /** Index of a buffer view. */
  view: JsonReader
}

let files = 0

/** The maps of one glTF file, in it or beside it; each is loaded when a material first asks for it. */
export class FileMaps {
  /** Tells the file from others that were loaded; nothing can be fetched there. */
  readonly address = `glTF ${++files}`
  readonly #json: JsonReader
  #entries: JsonReader[] | null = null
  readonly #loads = new Map<number, Promise<LoadedMap>>()
  /** Of the arrays so far, before compression. */
  #bytes = 0

  /** @param budget - bytes of all arrays in the file that materials use, before compression */
  constructor(
    private readonly parser: GLTFParser,
    private readonly places: FilePlaces,
    private readonly budget: number,
  ) {
    this.#json = new JsonReader(places.file, '', parser.json)
  }

  /** The map of that index, which has to be of that kind. */
  async load(index: JsonReader, kind: MapKind): Promise<LoadedMap> {
    this.#entries ??= this.#readEntries()
    const number = index.value
    const entry = typeof number === 'number' ? this.#entries[number] : undefined
    if (typeof number !== 'number' || entry === undefined)
      throw index.refuse(
        `an index of extensions.${EXTENSION}.maps, of which there are ${this.#entries.length}`,
      )
    let load = this.#loads.get(number)
    if (load === undefined) this.#loads.set(number, (load = this.#load(entry)))
    return expectKind(await load, kind)
  }

  #readEntries(): JsonReader[] {
    const extensions = this.#json.field('extensions')
    if (extensions.isMissing || extensions.field(EXTENSION).isMissing) return []
    const root = extensions.field(EXTENSION)
    expectOnly(root, ['maps'])
    return root.field('maps').list()
  }

  async #load(entry: JsonReader): Promise<LoadedMap> {
    const uriField = entry.field('uri')
    if (!uriField.isMissing) {
      expectOnly(entry, ['uri'])
      const uri = uriField.string()
      if (!RELATIVE_PATH.test(uri))
        throw uriField.refuse('a relative path to a .json, without scheme, host, query or fragment')
      return expectSound(
        await loadSharedMap(this.parser.options.path + uri.slice(0, -'.json'.length)),
      )
    }
    expectOnly(entry, MAP_FIELDS)
    const sidecar = readMapFields(entry, readArrayView)
    const url = `${this.address}/${entry.path}`
    this.places.add(`${url}.json`, entry.path)
    const arrays = await this.#arrays(entry, sidecar, url)
    return expectSound({ url, sidecar, arrays, verified: false })
  }

  async #arrays(
    entry: JsonReader,
    sidecar: Sidecar<ArrayView>,
    url: string,
  ): Promise<LoadedMap['arrays']> {
    const arrays: LoadedMap['arrays'] = {}
    for (const [name, { view, ...spec }] of Object.entries(sidecar.arrays)) {
      const field = entry.field('arrays').field(name)
      this.#bytes += bytesOf(spec)
      if (this.#bytes > this.budget)
        throw field
          .field('shape')
          .refuse(`no more than ${this.budget} bytes in the arrays of all maps of the file`)
      const owner = `${url}: ${name}`
      this.places.add(owner, field.path)
      arrays[name] = await readArray(owner, spec, (most) => this.#bytesOf(view, most))
    }
    return arrays
  }

  /** A buffer view that is longer is not looked at. */
  async #bytesOf(view: JsonReader, most: number): Promise<Uint8Array> {
    const index = view.value
    const views = this.#json.field('bufferViews')
    // Anything else would be turned into a text to be an index.
    const definition: unknown =
      typeof index === 'number' && !views.isMissing ? views.list()[index]?.value : undefined
    if (typeof index !== 'number' || definition === undefined)
      throw view.refuse('an index of bufferViews')
    const path = `bufferViews[${index}]`
    const length = new JsonReader(this.places.file, path, definition).field('byteLength')
    if (length.count() > most) throw length.refuse(`${most} at most`)
    try {
      const buffer: unknown = await this.parser.getDependency('bufferView', index)
      return new Uint8Array(buffer as ArrayBuffer)
    } catch (cause) {
      const value = String(cause)
      const expected = 'bytes that can be read'
      refuse(this.places.file, path, value, expected, cause)
    }
  }
}

function readArrayView(field: JsonReader): ArrayView {
  expectOnly(field, ARRAY_FIELDS)
  const axes = field.field('axes')
  if (!axes.isMissing) for (const axis of axes.list()) expectOnly(axis, AXIS_FIELDS)
  return { view: field.field('bufferView') }
}

const copies = new WeakMap<LoadedMap, Map<string, LoadedMap>>()

/** A height field's map that knows of no other methods than those whose maps a material has. */
export function withMethods(map: LoadedMap, methods: readonly string[]): LoadedMap {
  const { recipe } = map.sidecar
  const { methods: known } = recipe
  if (!Array.isArray(known) || known.every((method) => methods.includes(method as string)))
    return map
  let made = copies.get(map)
  if (made === undefined) copies.set(map, (made = new Map<string, LoadedMap>()))
  const key = methods.join()
  let copy = made.get(key)
  if (copy === undefined) {
    const sidecar = { ...map.sidecar, recipe: { ...recipe, methods } }
    made.set(key, (copy = { ...map, sidecar }))
  }
  return copy
}
