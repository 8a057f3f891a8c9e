import {
  CanvasTexture,
  Mesh,
  RepeatWrapping,
  SRGBColorSpace,
  Vector2,
  type BufferAttribute,
  type Texture,
  type WebGLRenderer,
} from 'three'
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js'
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js'
import type { DiffractionMaterial } from '../../../web'
import { GLTFDiffractionExporterPlugin, GLTFDiffractionLoaderPlugin } from '../../../web/gltf'
import { buildScene } from './build-scene'
import { renderTo } from './render'
import type { SceneDescription } from './scene-description'

export interface GltfRequest {
  scene: SceneDescription
  container: 'glb' | 'gltf'
  /** Patterned textures, each moved, turned and repeated in its own way. */
  textures?: ('map' | 'normalMap' | 'bumpMap')[]
  /** False: as a viewer loads the file that does not know the extension. */
  plugin?: false
  /** A field of the material's extension that is changed in the file. */
  change?: { path: (string | number)[]; value: unknown }
  /** The loaded mesh's texture coordinates are turned over. */
  flipped?: true
}

export interface GltfOutcome {
  /** Of the whole file. */
  bytes: number
  type: string
  errors: string[]
  /** Largest difference of any channel from the exported mesh's picture. */
  difference: number
  /** Largest channel of either picture. */
  largest: number
  /** Mean linear sRGB of the loaded mesh's picture where the mesh is. */
  mean: [number, number, number]
  /** Largest difference of the loaded mesh's matrix, positions, normals, tangents and texture coordinates. */
  moved: number
}

/** Draws a mesh, puts it into a file, loads that, and draws what came in the place of the first. */
export async function passThroughGltf(
  renderer: WebGLRenderer,
  { scene: description, container, textures = [], plugin, change, flipped }: GltfRequest,
): Promise<GltfOutcome> {
  const built = await buildScene(description)
  const { scene, mesh } = built
  const textured = textures.map((name) => patterned(mesh.material, name))
  const [width, height] = description.size
  const errors: string[] = []
  try {
    const before = renderTo(renderer, built, width, height, 1)
    const exporter = new GLTFExporter().register(
      (writer) => new GLTFDiffractionExporterPlugin(writer),
    )
    const file = await exporter.parseAsync(mesh, { binary: container === 'glb' })
    const data = changed(file, change)
    const loader = new GLTFLoader()
    if (plugin !== false)
      loader.register(
        (parser) =>
          new GLTFDiffractionLoaderPlugin(parser, {
            mapsPath: '/maps/baked/',
            onError: (error) => errors.push(error.message),
          }),
      )
    const { scene: loaded } = await loader.parseAsync(data, '')
    const [found] = loaded.children
    if (!(found instanceof Mesh)) throw new Error('There is no mesh')
    const twin = found as Mesh
    if ('ready' in twin.material) await (twin.material as DiffractionMaterial).ready
    const moved = largestMove(mesh, twin)
    // A matrix that is taken apart is rounded.
    twin.position.copy(mesh.position)
    twin.quaternion.copy(mesh.quaternion)
    twin.scale.copy(mesh.scale)
    if (flipped) turnOver(twin)
    scene.remove(mesh)
    scene.add(twin)
    scene.updateMatrixWorld()
    const after = renderTo(renderer, built, width, height, 1)
    return {
      bytes: data instanceof ArrayBuffer ? data.byteLength : data.length,
      type: (twin.material as DiffractionMaterial).type,
      errors,
      ...compared(before, after),
      moved,
    }
  } finally {
    built.dispose()
    for (const texture of textured) texture.dispose()
  }
}

/** The file as a loader takes it. */
function changed(
  file: ArrayBuffer | Record<string, unknown>,
  change: GltfRequest['change'],
): ArrayBuffer | string {
  if (file instanceof ArrayBuffer) {
    if (change !== undefined) throw new Error('Only fields of a .gltf can be changed')
    return file
  }
  if (change !== undefined) {
    const [material] = file.materials as { extensions: Record<string, unknown> }[]
    let place = material!.extensions.TDIFF_materials_diffraction as Record<string | number, unknown>
    for (const key of change.path.slice(0, -1)) place = place[key] as typeof place
    // Without a value JSON leaves the field out.
    place[change.path.at(-1)!] = change.value
  }
  return JSON.stringify(file)
}

function patterned(material: DiffractionMaterial, name: 'map' | 'normalMap' | 'bumpMap'): Texture {
  const canvas = document.createElement('canvas')
  canvas.width = canvas.height = 64
  const context = canvas.getContext('2d')!
  const image = context.createImageData(64, 64)
  for (let i = 0; i < 64 * 64; i++) {
    const [x, y] = [i % 64, Math.floor(i / 64)]
    const wave = Math.sin((2 * Math.PI * (x + 3 * y)) / 64)
    const texel =
      name === 'map'
        ? [4 * x, 4 * y, x > y ? 255 : 30]
        : name === 'normalMap'
          ? [128 + 20 * wave, 128 + 4 * Math.cos(x / 5), 250]
          : [128 + 100 * wave, 0, 0]
    image.data.set([...texel, 255], 4 * i)
  }
  context.putImageData(image, 0, 0)
  const texture = new CanvasTexture(canvas)
  if (name === 'map') texture.colorSpace = SRGBColorSpace
  texture.wrapS = texture.wrapT = RepeatWrapping
  texture.offset.set(0.2, 0.1)
  // three's exporter writes its own order of these as if it were glTF's, which it is where both repeats are the same.
  // Enlarged: three turns normal maps over for meshes without tangents, whose mip levels are then rounded otherwise.
  texture.repeat.set(0.5, 0.5)
  texture.rotation = 0.4
  material[name] = texture
  if (name === 'normalMap') material.normalScale.copy(new Vector2(0.7, 0.7))
  if (name === 'bumpMap') material.bumpScale = 0.05
  return texture
}

function compared(
  before: Float32Array,
  after: Float32Array,
): Pick<GltfOutcome, 'difference' | 'largest' | 'mean'> {
  let [difference, largest, count] = [0, 0, 0]
  const sums: [number, number, number] = [0, 0, 0]
  after.forEach((value, i) => {
    difference = Math.max(difference, Math.abs(value - before[i]!))
    if (i % 4 === 3) {
      if (value > 0) count++
      return
    }
    largest = Math.max(largest, Math.abs(value), Math.abs(before[i]!))
    sums[i % 4]! += value
  })
  return { difference, largest, mean: sums.map((sum) => sum / count) as typeof sums }
}

function largestMove(mesh: Mesh, twin: Mesh): number {
  twin.updateMatrixWorld()
  const pairs = ['position', 'normal', 'tangent', 'uv'].map((name) => [
    mesh.geometry.getAttribute(name) as BufferAttribute | undefined,
    twin.geometry.getAttribute(name) as BufferAttribute | undefined,
  ])
  const lists = [
    [mesh.matrixWorld.elements, twin.matrixWorld.elements],
    ...pairs.map((pair) => pair.map((attribute) => [...(attribute?.array ?? [])])),
  ]
  const moves = lists.flatMap(([a, b]) => [
    a!.length - b!.length,
    ...a!.map((value, i) => value - b![i]!),
  ])
  return moves.reduce((most, move) => Math.max(most, Math.abs(move)), 0)
}

function turnOver(mesh: Mesh): void {
  const uv = mesh.geometry.getAttribute('uv')
  for (let i = 0; i < uv.count; i++) uv.setY(i, 1 - uv.getY(i))
}
