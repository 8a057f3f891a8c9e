import type { Texture } from 'three'
import type { GLTFWriter } from 'three/addons/exporters/GLTFExporter.js'
import { refuse } from '../errors.ts'
import type { DiffractionMaterial } from '../materials/DiffractionMaterial.ts'
import { DEFAULT_SETTINGS } from '../materials/options.ts'
import { spectrumUrls } from '../spectrum/spectrum-maps.ts'
import { Foil } from '../surfaces/foil.ts'
import { Grating } from '../surfaces/grating.ts'
import type { GratingSurface } from '../surfaces/grating-surface.ts'
import { HeightField } from '../surfaces/height-field.ts'
import { PROFILES, profileUrl } from '../surfaces/profile.ts'
import type { OpticsSettings } from '../surfaces/surface.ts'
import { within } from '../validation.ts'
import {
  CHOSEN_FIELDS,
  FIELD_MAPS,
  GIVEN_FIELDS,
  MATERIAL_FIELDS,
  RENDERING_FIELDS,
  SURFACE_FIELDS,
  writeFields,
  type Fields,
} from './fields.ts'
import type { MapWriter } from './map-writer.ts'
import { tableOf } from './tables.ts'

type Json = Record<string, unknown>

/** Illuminants whose maps come with the package, by observer. */
const ILLUMINANTS: Record<string, readonly string[]> = {
  '1931-2': ['D65', 'A', 'inverse-A', 'LED-B1', 'LED-B2', 'LED-B3', 'LED-B4', 'LED-B5'],
  '2015-2': ['D65'],
}

/** The extension of a material whose tables are there. */
export async function writeMaterial(
  material: DiffractionMaterial,
  maps: MapWriter,
  writer: GLTFWriter,
): Promise<Json> {
  const { illuminant, observer, mapsPath, color, map } = material
  const rendering = writeFields(material, {
    ...RENDERING_FIELDS,
    ...givenOf(material, CHOSEN_FIELDS),
  })
  const rgb = color.toArray().map((share) => within('DiffractionMaterial', 'color', share, 0, 1))
  return {
    surface: await writeSurface(material, maps),
    ...writeFields(material, { ...MATERIAL_FIELDS, ...givenOf(material, GIVEN_FIELDS) }),
    ...(ILLUMINANTS[observer]!.includes(illuminant)
      ? { illuminant }
      : { illuminantMap: await indexOf(material, spectrumUrls(material, mapsPath).lobes, maps) }),
    ...(rgb.some((share) => share < 1) && { matteColorFactor: rgb }),
    ...(map !== null && { matteColorTexture: await writeTexture(map, writer) }),
    ...(Object.keys(rendering).length > 0 && { rendering }),
  }
}

/** Of fields that are settings, those that were given. */
function givenOf({ given }: DiffractionMaterial, fields: Fields): Fields {
  const found = Object.entries(fields).filter(([name]) => given.has(name as keyof OpticsSettings))
  return Object.fromEntries(found)
}

async function writeSurface(material: DiffractionMaterial, maps: MapWriter): Promise<Json> {
  const { surface } = material
  if (surface instanceof Grating)
    return {
      kind: 'grating',
      ...writeFields(surface, SURFACE_FIELDS.grating),
      ...(await writeProfile(material, surface, maps)),
    }
  if (surface instanceof Foil)
    return {
      kind: 'foil',
      map: await maps.indexOf(surface.map),
      ...writeFields(surface, SURFACE_FIELDS.foil),
      ...(await writeProfile(material, surface, maps)),
    }
  if (surface instanceof HeightField)
    return {
      kind: 'heightField',
      maps: await writeFieldMaps(material, surface, maps),
      ...writeFields(surface, SURFACE_FIELDS.heightField),
    }
  refuse(
    'GLTFDiffractionExporterPlugin',
    'surface',
    surface.name,
    'a Grating, a Foil or a HeightField',
  )
}

async function writeProfile(
  material: DiffractionMaterial,
  { name, profile }: GratingSurface,
  maps: MapWriter,
): Promise<Json> {
  if ((PROFILES as readonly string[]).includes(profile)) return { profile }
  const address = profileUrl(name, profile, material.mapsPath)
  return { profileMap: await indexOf(material, address, maps) }
}

/** The map of the method that is drawn and, where an error chooses it, those of the others that are known. */
async function writeFieldMaps(
  material: DiffractionMaterial,
  surface: HeightField,
  maps: MapWriter,
): Promise<Json> {
  const settings = settingsOf(material)
  const methods = [
    settings.method,
    ...(material.maxError === null ? [] : surface.methodsKnown(settings)),
  ]
  const written: Json = {}
  for (const method of methods) {
    const address = surface.tables({ ...settings, method }, material.mapsPath).relief!
    const name = FIELD_MAPS.find((map) => address.endsWith(`-${map}`))!
    written[name] ??= await indexOf(material, address, maps)
  }
  return written
}

async function indexOf(
  material: DiffractionMaterial,
  address: string,
  maps: MapWriter,
): Promise<number> {
  return maps.indexOf(await tableOf(material, address))
}

function settingsOf(material: DiffractionMaterial): OpticsSettings {
  const names = Object.keys(DEFAULT_SETTINGS) as (keyof OpticsSettings)[]
  return Object.fromEntries(
    names.map((name) => [name, material[name]]),
  ) as unknown as OpticsSettings
}

async function writeTexture(texture: Texture, writer: GLTFWriter): Promise<Json> {
  const definition: Json = { index: await writer.processTextureAsync(texture) }
  if (texture.channel > 0) definition.texCoord = texture.channel
  writer.applyTextureTransform(definition, texture)
  return definition
}
