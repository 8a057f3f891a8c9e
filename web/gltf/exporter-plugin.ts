import type { Material, MeshStandardMaterial } from 'three'
import type { GLTFExporterPlugin, GLTFWriter } from 'three/addons/exporters/GLTFExporter.js'
import { refuse } from '../errors.ts'
import type { LoadedMap } from '../maps/load.ts'
import { DiffractionMaterial } from '../materials/DiffractionMaterial.ts'
import { EXTENSION } from './fields.ts'
import { MapWriter, type GLTFWriterInternals } from './map-writer.ts'
import { plainMaterial } from './plain-material.ts'
import { writeMaterial } from './write-material.ts'

/** Whether maps go into the file or beside it. */
export interface GLTFDiffractionExporterOptions {
  /**
   * The relative path of a map's sidecar, as the file is to name it; null (default) puts the map into the file. Lays down no
   * sidecar.
   */
  uriOf?: (map: LoadedMap) => string | null
}

/** The writer's step that refuses shaders before it asks any plugin. */
interface MaterialWriter extends GLTFWriterInternals {
  processMaterialAsync: (material: Material, ...rest: unknown[]) => Promise<number | null>
}

/**
 * Writes every DiffractionMaterial as a plain metal with the extension TDIFF_materials_diffraction:
 * `exporter.register((writer) => new GLTFDiffractionExporterPlugin(writer, options))`.
 *
 * Exporting fails with the DiffractionError of a material whose tables do not come, or of a surface that glTF has no
 * words for.
 */
export class GLTFDiffractionExporterPlugin implements GLTFExporterPlugin {
  /** The name of the extension. */
  readonly name = EXTENSION
  readonly #maps: MapWriter
  /** What is written in a material's place. */
  readonly #plain = new Map<DiffractionMaterial, Promise<MeshStandardMaterial>>()
  readonly #sources = new Map<Material, DiffractionMaterial>()

  /**
   * @param writer - what `GLTFExporter.register` hands over
   * @param options - whether maps go into the file or beside it
   */
  constructor(
    private readonly writer: GLTFWriter,
    { uriOf = () => null }: GLTFDiffractionExporterOptions = {},
  ) {
    const internals = writer as MaterialWriter
    this.#maps = new MapWriter(internals, uriOf)
    const process = internals.processMaterialAsync as
      MaterialWriter['processMaterialAsync'] | undefined
    if (process === undefined)
      refuse(
        'GLTFExporter',
        'processMaterialAsync',
        undefined,
        'the step of its writer by which this plugin hands it materials',
      )
    internals.processMaterialAsync = async (material, ...rest) =>
      process.call(
        internals,
        material instanceof DiffractionMaterial ? await this.#plainOf(material) : material,
        ...rest,
      )
  }

  /**
   * Called by three's exporter for every material that it has written.
   *
   * @param material - what was written
   * @param definition - its glTF material, to which the extension is added
   */
  async writeMaterialAsync(material: Material, definition: Record<string, unknown>): Promise<void> {
    const source = this.#sources.get(material)
    if (source === undefined) return
    const { extensions = {} } = definition
    definition.extensions = {
      ...(extensions as object),
      [EXTENSION]: await writeMaterial(source, this.#maps, this.writer),
    }
    this.writer.extensionsUsed[EXTENSION] = true
  }

  #plainOf(material: DiffractionMaterial): Promise<MeshStandardMaterial> {
    let plain = this.#plain.get(material)
    if (plain === undefined) this.#plain.set(material, (plain = this.#makePlain(material)))
    return plain
  }

  async #makePlain(material: DiffractionMaterial): Promise<MeshStandardMaterial> {
    await material.ready
    const plain = await plainMaterial(material)
    this.#sources.set(plain, material)
    return plain
  }
}
