import type { GLTFWriter } from 'three/addons/exporters/GLTFExporter.js'
import type { LoadedMap, MapArray } from '../maps/load.ts'
import { encodePng } from './encode-png.ts'
import { EXTENSION } from './fields.ts'

/** What of three's writer is not in its declarations, but its own plugins use. */
export interface GLTFWriterInternals extends GLTFWriter {
  json: {
    extensions?: Record<string, unknown>
    bufferViews?: { buffer: number; byteOffset: number; byteLength: number }[]
  }
  /** Length of the buffer so far. */
  byteOffset: number
  /** Takes bytes, a multiple of 4, to the end of the buffer; returns its index. */
  processBuffer: (bytes: ArrayBuffer) => number
}

/** Puts maps into a glTF file, each once. */
export class MapWriter {
  readonly #entries: unknown[] = []
  readonly #indices = new Map<LoadedMap, Promise<number>>()

  /** @param uriOf - the relative path of a map's sidecar, where it is not to be put into the file */
  constructor(
    private readonly writer: GLTFWriterInternals,
    private readonly uriOf: (map: LoadedMap) => string | null,
  ) {}

  /** The map's index in the file. */
  indexOf(map: LoadedMap): Promise<number> {
    let index = this.#indices.get(map)
    if (index === undefined) this.#indices.set(map, (index = this.#write(map)))
    return index
  }

  async #write(map: LoadedMap): Promise<number> {
    const uri = this.uriOf(map)
    const entry = uri === null ? await this.#embedded(map) : { uri }
    const { json } = this.writer
    json.extensions ??= {}
    json.extensions[EXTENSION] ??= { maps: this.#entries }
    return this.#entries.push(entry) - 1
  }

  async #embedded({ sidecar, arrays }: LoadedMap): Promise<object> {
    const { format, version, kind, quantity, symbol, constants, recipe } = sidecar
    const written: Record<string, object> = {}
    // In the sidecar's order: they were loaded in any.
    for (const [name, { dtype, shape, axes, channels, decode }] of Object.entries(sidecar.arrays)) {
      const bufferView = this.#bufferView(await bytesOf(arrays[name]!))
      written[name] = {
        ...{ bufferView, dtype, shape, channels },
        ...(axes.length > 0 && { axes }),
        ...(decode !== null && { decode }),
      }
    }
    return { format, version, kind, quantity, symbol, arrays: written, constants, recipe }
  }

  #bufferView(bytes: Uint8Array): number {
    const { writer } = this
    // The next view begins at a multiple of 4, as accessors have to.
    const padded = new Uint8Array(Math.ceil(bytes.length / 4) * 4)
    padded.set(bytes)
    writer.json.bufferViews ??= []
    const buffer = writer.processBuffer(padded.buffer)
    const { byteOffset } = writer
    writer.byteOffset += padded.length
    return writer.json.bufferViews.push({ buffer, byteOffset, byteLength: bytes.length }) - 1
  }
}

async function bytesOf({ spec, data }: MapArray): Promise<Uint8Array> {
  if (data instanceof Uint8Array) return encodePng(data, spec.shape as [number, number])
  return new Uint8Array(data.buffer, data.byteOffset, data.byteLength)
}
