import { Mesh, MeshStandardMaterial, type Material, type Object3D } from 'three'
import type { GLTF, GLTFLoaderPlugin, GLTFParser } from 'three/addons/loaders/GLTFLoader.js'
import { DiffractionError } from '../errors.ts'
import { JsonReader } from '../maps/json.ts'
import { DiffractionMaterial } from '../materials/DiffractionMaterial.ts'
import { CHOSEN_FIELDS, EXTENSION, RENDERING_FIELDS } from './fields.ts'
import { FileMaps } from './file-maps.ts'
import { FilePlaces } from './file-places.ts'
import { readMaterial } from './read-material.ts'

/** Where tables are, and what a file may ask for. */
export interface GLTFDiffractionLoaderOptions {
  /** Folder of the baked tables, with its slash; 'maps/baked/' by default. */
  mapsPath?: string
  /**
   * Whether the file's hints of how to draw are followed (default); false leaves method, steps and nodes to the material's
   * defaults, and with them how long a stranger's file takes to draw.
   */
  rendering?: boolean
  /** Bytes before compression that the arrays of all maps in a file may have; 2²⁴ by default: a foil of 2048 × 2048 texels. */
  maxMapBytes?: number
  /**
   * Told of each material that cannot be shown as it says, and is shown without diffraction; prints to the console by
   * default. What it throws ends the loading of the file.
   */
  onError?: (error: DiffractionError) => void
}

/**
 * Makes a DiffractionMaterial of every glTF material with the extension TDIFF_materials_diffraction:
 * `loader.register((parser) => new GLTFDiffractionLoaderPlugin(parser, options))`.
 *
 * A material waits for its tables, so that a file that is loaded can be drawn. Where anything is wrong with the extension
 * the file's own material without it stays, a plain metal, and `onError` is told.
 */
export class GLTFDiffractionLoaderPlugin implements GLTFLoaderPlugin {
  /** The name of the extension. */
  readonly name = EXTENSION
  readonly #places: FilePlaces
  readonly #maps: FileMaps
  readonly #options: Required<GLTFDiffractionLoaderOptions>
  /** Materials of the file without the extension, by index. */
  readonly #fallbacks = new Map<number, Material>()

  /**
   * @param parser - what `GLTFLoader.register` hands over
   * @param options - where tables are, and what a file may ask for
   */
  constructor(
    private readonly parser: GLTFParser,
    options: GLTFDiffractionLoaderOptions = {},
  ) {
    this.#options = {
      mapsPath: 'maps/baked/',
      rendering: true,
      maxMapBytes: 2 ** 24,
      onError: (error) => {
        console.error(error)
      },
      ...options,
    }
    const { path } = parser.options
    this.#places = new FilePlaces(path === '' ? 'glTF' : `glTF in ${path}`)
    this.#maps = new FileMaps(parser, this.#places, this.#options.maxMapBytes)
  }

  /**
   * Called by three's loader for every material; null for those without the extension.
   *
   * @param index - the material's index in the file
   */
  loadMaterial(index: number): Promise<Material> | null {
    const { materials } = this.parser.json as { materials: { extensions?: object }[] }
    const extensions = materials[index]?.extensions as Record<string, unknown> | undefined
    const json = extensions?.[EXTENSION]
    return json === undefined ? null : this.#load(index, json)
  }

  /**
   * Called by three's loader when all is there. Where a primitive has no texture coordinates there is no direction to put
   * grooves along: it shows the plain material.
   *
   * @param gltf - what was loaded
   */
  afterRoot({ scenes }: GLTF): null {
    for (const scene of scenes)
      scene.traverse((object) => {
        if (isUndirected(object)) this.#fallBack(object)
      })
    return null
  }

  #fallBack(mesh: Mesh): void {
    const { associations } = this.parser
    const { meshes = 0, primitives = 0 } = associations.get(mesh) ?? {}
    const { materials = 0 } = associations.get(mesh.material as Material) ?? {}
    const fallback = this.#fallbacks.get(materials)
    if (fallback === undefined) return
    mesh.material = fallback
    this.parser.assignFinalMaterial(mesh)
    this.#options.onError(
      new DiffractionError({
        file: this.#places.file,
        field: `meshes[${meshes}].primitives[${primitives}].attributes.TEXCOORD_0`,
        value: undefined,
        expected: 'texture coordinates, which say how grooves run',
      }),
    )
  }

  async #load(index: number, json: unknown): Promise<Material> {
    const fallback = await this.parser.loadMaterial(index)
    this.#fallbacks.set(index, fallback)
    const path = `materials[${index}].extensions.${EXTENSION}`
    const places = this.#placesOf(path)
    try {
      const reader = new JsonReader(places.file, path, json)
      const material = await this.#diffracting(index, reader, fallback)
      this.parser.associations.set(material, { materials: index })
      return material
    } catch (error) {
      if (!(error instanceof DiffractionError)) throw error
      this.#options.onError(places.errorOf(error))
      return fallback
    }
  }

  async #diffracting(
    index: number,
    reader: JsonReader,
    fallback: Material,
  ): Promise<DiffractionMaterial> {
    const { mapsPath, rendering, onError } = this.#options
    this.#expectDrawable(index)
    const material = new DiffractionMaterial({
      ...(await readMaterial(reader, this.#maps, this.parser, rendering)),
      mapsPath,
      // What goes wrong until it is ready is told once, below.
      onError: () => undefined,
    })
    await material.ready
    material.onError = onError
    takeOver(material, fallback)
    return material
  }

  /** What else may stand in a material, and cannot be drawn with it. */
  #expectDrawable(index: number): void {
    const material = new JsonReader(this.#places.file, '', this.parser.json)
      .field('materials')
      .list()[index]!
    if (!material.field('extensions').field('KHR_materials_unlit').isMissing)
      throw material
        .field('extensions')
        .field('KHR_materials_unlit')
        .refuse(`none beside ${EXTENSION}`)
    const mode = material.field('alphaMode')
    if (!mode.isMissing) mode.oneOf(['OPAQUE', 'BLEND'])
  }

  #placesOf(path: string): FilePlaces {
    const places = new FilePlaces(this.#places.file, this.#places)
    for (const surface of ['Grating', 'Foil', 'HeightField']) places.add(surface, `${path}.surface`)
    places.addField('HeightField', 'field', `${path}.surface.maps`)
    places.add('DiffractionMaterial', path)
    for (const name of Object.keys({ ...RENDERING_FIELDS, ...CHOSEN_FIELDS }))
      places.addField('DiffractionMaterial', name, `${path}.rendering.${name}`)
    return places
  }
}

function isUndirected(object: Object3D): object is Mesh {
  return (
    object instanceof Mesh &&
    object.material instanceof DiffractionMaterial &&
    !(object as Mesh).geometry.hasAttribute('uv')
  )
}

/** What a glTF material has apart from how it reflects. */
function takeOver(material: DiffractionMaterial, fallback: Material): void {
  const { name, side, transparent, depthWrite, opacity, userData } = fallback
  material.setValues({ name, side, transparent, depthWrite, opacity, userData })
  if (!(fallback instanceof MeshStandardMaterial)) return
  const { normalMap, normalScale, bumpMap, bumpScale } = fallback
  Object.assign(material, { normalMap, bumpMap, bumpScale })
  material.normalScale.copy(normalScale)
}
