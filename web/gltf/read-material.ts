import { Color, SRGBColorSpace, Vector2, type Texture } from 'three'
import type { GLTFParser } from 'three/addons/loaders/GLTFLoader.js'
import type { JsonReader } from '../maps/json.ts'
import type { MapKind } from '../maps/sidecar.ts'
import type { LoadedMap } from '../maps/load.ts'
import { DEFAULT_SETTINGS, type DiffractionMaterialOptions } from '../materials/options.ts'
import { Foil } from '../surfaces/foil.ts'
import { Grating, type GratingOptions } from '../surfaces/grating.ts'
import { HeightField } from '../surfaces/height-field.ts'
import type { Method, Surface } from '../surfaces/surface.ts'
import {
  CHOSEN_FIELDS,
  expectOnly,
  FIELD_MAPS,
  GIVEN_FIELDS,
  MATERIAL_FIELDS,
  numbers,
  readFields,
  RENDERING_FIELDS,
  SURFACE_FIELDS,
  type SurfaceKind,
} from './fields.ts'
import { withMethods, type FileMaps } from './file-maps.ts'

/** The maps of each kind of surface, besides its fields. */
const SURFACE_MAPS = {
  grating: ['profile', 'profileMap'],
  foil: ['map', 'profile', 'profileMap'],
  heightField: ['maps'],
} as const

/** Becomes part of an address, where others would lead elsewhere. */
const NAME = /^[A-Za-z0-9][A-Za-z0-9._-]*$/

/**
 * What a material's extension says, its maps and textures loaded. Ranges are left to the classes that take the values.
 *
 * @param isRendered - whether the hints of how to draw are read
 */
export async function readMaterial(
  reader: JsonReader,
  files: FileMaps,
  parser: GLTFParser,
  isRendered: boolean,
): Promise<DiffractionMaterialOptions> {
  expectOnly(reader, [
    ...['surface', 'illuminant', 'illuminantMap', 'matteColorFactor', 'matteColorTexture'],
    ...Object.keys({ ...MATERIAL_FIELDS, ...GIVEN_FIELDS }),
    'rendering',
  ])
  const rendering = reader.field('rendering')
  const hints = { ...RENDERING_FIELDS, ...CHOSEN_FIELDS }
  if (!rendering.isMissing) expectOnly(rendering, Object.keys(hints))
  const tables = new OwnTables(files, `${files.address}/${reader.path}`)
  const illuminant = await tables.read(reader, 'illuminant', 'lobes')
  const surface = await readSurface(reader.field('surface'), files, tables)
  const drawn = isRendered && !rendering.isMissing ? readFields(rendering, hints) : {}
  if (surface instanceof HeightField) {
    const methods = tables.methodsOf(surface)
    if (drawn.method !== undefined) rendering.field('method').oneOf(methods)
    else if (methods[0] !== surface.methods[0]) drawn.method = methods[0]
  }
  return {
    surface,
    ...readFields(reader, { ...MATERIAL_FIELDS, ...GIVEN_FIELDS }),
    ...drawn,
    ...(illuminant !== undefined && { illuminant }),
    ...readMatte(reader),
    ...(await readMatteTexture(reader.field('matteColorTexture'), parser)),
    maps: tables.maps,
  }
}

/** The tables of one material that are maps of its file, under addresses of its own. */
class OwnTables {
  readonly maps: Record<string, LoadedMap> = {}

  constructor(
    private readonly files: FileMaps,
    private readonly address: string,
  ) {}

  /** Name or address of a table that is given by its name, or by the index of its map; undefined where it is by neither. */
  async read(reader: JsonReader, name: string, kind: MapKind): Promise<string | undefined> {
    const byName = reader.field(name)
    const byMap = reader.field(`${name}Map`)
    if (!byMap.isMissing) {
      if (!byName.isMissing) throw byMap.refuse(`none beside ${name}`)
      return this.#add(name, await this.files.load(byMap, kind))
    }
    if (byName.isMissing) return undefined
    if (NAME.test(byName.string())) return byName.string()
    throw byName.refuse('a name of letters, digits, dots, _ and -')
  }

  /** Address of a height field, without its method. */
  async readField(reader: JsonReader): Promise<string> {
    expectOnly(reader, FIELD_MAPS)
    const methods = FIELD_MAPS.filter((method) => !reader.field(method).isMissing)
    if (methods.length === 0) throw reader.refuse(`one of ${FIELD_MAPS.join(', ')}`)
    for (const method of methods) {
      const kind = method === 'baked' ? 'height-field-baked' : 'height-field-terms'
      const map = await this.files.load(reader.field(method), kind)
      this.#add(`field-${method}`, withMethods(map, methods))
    }
    return `${this.address}/field`
  }

  /** Methods whose maps are there. */
  methodsOf(field: HeightField): Method[] {
    return field.methods.filter(
      (method) => field.tables({ ...DEFAULT_SETTINGS, method }, '').relief! in this.maps,
    )
  }

  #add(name: string, map: LoadedMap): string {
    const address = `${this.address}/${name}`
    this.maps[address] = map
    return address
  }
}

async function readSurface(
  reader: JsonReader,
  files: FileMaps,
  tables: OwnTables,
): Promise<Surface> {
  const kind = reader.field('kind').oneOf(Object.keys(SURFACE_FIELDS) as SurfaceKind[])
  const fields = SURFACE_FIELDS[kind]
  expectOnly(reader, ['kind', ...SURFACE_MAPS[kind], ...Object.keys(fields)])
  const options = readFields(reader, fields)
  if (kind === 'heightField')
    return new HeightField({ ...options, field: await tables.readField(reader.field('maps')) })
  const profile = await tables.read(reader, 'profile', 'profile')
  if (profile !== undefined) options.profile = profile
  if (kind === 'grating') return new Grating(options as unknown as GratingOptions)
  if (options.repeat !== undefined) options.repeat = new Vector2(...(options.repeat as number[]))
  return Foil.of(await files.load(reader.field('map'), 'foil'), options)
}

function readMatte(reader: JsonReader): { color?: Color } {
  const field = reader.field('matteColorFactor')
  if (field.isMissing) return {}
  const rgb = numbers(field, 3)
  for (const share of rgb) if (share < 0 || share > 1) throw field.refuse('numbers from 0 to 1')
  return { color: new Color().setRGB(...(rgb as [number, number, number])) }
}

async function readMatteTexture(field: JsonReader, parser: GLTFParser): Promise<{ map?: Texture }> {
  if (field.isMissing) return {}
  expectOnly(field, ['index', 'texCoord'])
  const index = field.field('index').number()
  const texCoord = field.field('texCoord')
  // The number becomes part of a shader.
  if (!texCoord.isMissing && ![0, 1, 2, 3].includes(texCoord.number()))
    throw texCoord.refuse('0 to 3')
  const found: { map?: Texture } = {}
  const definition = { ...field.object(), index }
  try {
    await parser.assignTexture(found, 'map', definition, SRGBColorSpace)
  } catch {
    // The loader trips over what is missing.
  }
  if (found.map === undefined) throw field.refuse('a texture that can be loaded')
  return found
}
