import { Mesh, PlaneGeometry, Scene, type Material } from 'three'
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js'
import { GLTFLoader, type GLTF } from 'three/addons/loaders/GLTFLoader.js'
import { vi } from 'vitest'
import {
  GLTFDiffractionExporterPlugin,
  GLTFDiffractionLoaderPlugin,
  type GLTFDiffractionExporterOptions,
  type GLTFDiffractionLoaderOptions,
} from '../../web/gltf'
import { DiffractionMaterial } from '../../web/materials/DiffractionMaterial'
import { Foil } from '../../web/surfaces/foil'

export type Json = Record<string, unknown>

/** What of a browser three's exporter and loader ask for, and Node has not. */
export function stubBrowser(): void {
  vi.stubGlobal(
    'FileReader',
    class {
      result: unknown = null
      onloadend: () => void = () => undefined
      readAsArrayBuffer(blob: Blob): void {
        void blob.arrayBuffer().then((bytes) => {
          this.result = bytes
          this.onloadend()
        })
      }
      readAsDataURL(blob: Blob): void {
        void blob.arrayBuffer().then((bytes) => {
          this.result = `data:${blob.type};base64,${Buffer.from(bytes).toString('base64')}`
          this.onloadend()
        })
      }
    },
  )
  vi.stubGlobal('ProgressEvent', Event)
  // Node's takes no relative address.
  vi.stubGlobal(
    'Request',
    class extends Request {
      constructor(address: string, options: RequestInit) {
        super(new URL(address, HOST), options)
      }
    },
  )
}

const HOST = 'http://host/'

const { fetch: fetchAnything } = globalThis

/** Lets three's loader, too, read what a stubbed `fetch` serves by name, and data addresses. */
export function serveData(): void {
  const { fetch: served } = globalThis
  vi.stubGlobal('fetch', (address: string | Request) => {
    if (typeof address === 'string') return served(address)
    return address.url.startsWith('data:')
      ? fetchAnything(address)
      : served(address.url.replace(HOST, ''))
  })
}

/** A plane of that material. */
export function sceneOf(material: Material): Scene {
  return new Scene().add(new Mesh(new PlaneGeometry(1, 1), material))
}

export async function exportGlb(
  scene: Scene,
  options?: GLTFDiffractionExporterOptions,
): Promise<ArrayBuffer> {
  return (await exporter(options).parseAsync(scene, { binary: true })) as ArrayBuffer
}

export async function exportJson(
  scene: Scene,
  options?: GLTFDiffractionExporterOptions,
): Promise<Json> {
  return (await exporter(options).parseAsync(scene)) as Json
}

function exporter(options?: GLTFDiffractionExporterOptions): GLTFExporter {
  return new GLTFExporter().register((writer) => new GLTFDiffractionExporterPlugin(writer, options))
}

/** A file as three's loader shows it with our plugin. */
export function load(
  file: ArrayBuffer | Json,
  options?: GLTFDiffractionLoaderOptions,
  path = '',
): Promise<GLTF> {
  const data = file instanceof ArrayBuffer ? file : JSON.stringify(file)
  return new GLTFLoader()
    .register((parser) => new GLTFDiffractionLoaderPlugin(parser, options))
    .parseAsync(data, path)
}

/** The materials of all meshes. */
export function materialsOf({ scene }: Pick<GLTF, 'scene'>): Material[] {
  const found: Material[] = []
  scene.traverse((object) => {
    if (!(object instanceof Mesh)) return
    const { material } = object as Mesh
    found.push(...(Array.isArray(material) ? material : [material]))
  })
  return found
}

/** Those of all meshes, each of which diffracts, when they are ready. */
export async function diffractingOf(gltf: GLTF): Promise<DiffractionMaterial[]> {
  const materials = materialsOf(gltf).map((material) => {
    if (material instanceof DiffractionMaterial) return material
    throw new Error(`It is a ${material.type}`)
  })
  await Promise.all(materials.map(({ ready }) => ready))
  return materials
}

/** The surface of a material, which is a foil. */
export function foilOf({ surface }: DiffractionMaterial): Foil {
  if (surface instanceof Foil) return surface
  throw new Error(`It is a ${surface.name}`)
}

const GLB_HEADER = 12
const CHUNK_HEADER = 8

/** A GLB's JSON and its binary. */
export function partsOf(glb: ArrayBuffer): { json: Json; binary: Uint8Array } {
  const length = new DataView(glb).getUint32(GLB_HEADER, true)
  const start = GLB_HEADER + CHUNK_HEADER
  const json = JSON.parse(new TextDecoder().decode(new Uint8Array(glb, start, length))) as Json
  return { json, binary: new Uint8Array(glb, start + length + CHUNK_HEADER) }
}

/** A GLB of a text and a binary. */
export function glbOf(text: string, binary: Uint8Array): ArrayBuffer {
  const json = padded(new TextEncoder().encode(text), 0x20)
  const bytes = padded(binary, 0)
  const header = new DataView(new ArrayBuffer(GLB_HEADER + 2 * CHUNK_HEADER))
  const total = header.byteLength + json.length + bytes.length
  const words = [0x46546c67, 2, total, json.length, 0x4e4f534a, bytes.length, 0x004e4942]
  words.forEach((word, i) => {
    header.setUint32(4 * i, word, true)
  })
  const parts = [
    new Uint8Array(header.buffer, 0, GLB_HEADER + CHUNK_HEADER),
    json,
    new Uint8Array(header.buffer, GLB_HEADER + CHUNK_HEADER),
    bytes,
  ]
  return new Uint8Array(Buffer.concat(parts)).buffer
}

function padded(bytes: Uint8Array, filler: number): Uint8Array {
  const whole = new Uint8Array(Math.ceil(bytes.length / 4) * 4).fill(filler)
  whole.set(bytes)
  return whole
}
