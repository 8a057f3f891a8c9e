import { Foil, Grating, HeightField, type DiffractionMaterial } from '../../web'
import { Color, InstancedMesh, type Vector3 } from 'three'
import { loadSharedMap } from '../../web/maps/cache'
import type { LoadedMap } from '../../web/maps/load'
import { maxOrder } from '../../web/spectrum/max-order'
import { metalReflectance } from '../../web/spectrum/metal-reflectance'
import { profileUrl } from '../../web/surfaces/profile'
import { spectrumUrls } from '../../web/spectrum/spectrum-maps'
import type { Subject } from '../subjects/subject'
import { coatPassing, type Coat } from './optics/coat'
import { efficiencyOf } from './optics/efficiency'
import { bentFrame } from './optics/foil-bumps'
import { fresnel } from './optics/fresnel'
import type { GratingOptics } from './optics/grating-brdf'
import { gratingAt, type GratingAt } from './optics/grating-at'
import {
  LightSpectrum,
  illuminantA,
  illuminantSpectrum,
  type Colour,
} from './optics/light-spectrum'
import type { Direction } from './optics/orders'
import { Relief, type ReliefOptics } from './optics/relief'
import type { PickedPoint, PointFrame } from './picked-point'

/** The tables of what is on show. */
export interface Tables {
  lobes: LoadedMap
  metals: LoadedMap
  /** Of gratings. */
  profile: LoadedMap | null
  /** Of height fields. */
  relief: LoadedMap | null
}

/** What goes with the tables and not with the point. */
export interface SpectralTables {
  maps: Tables
  spectrum: LightSpectrum
  /** Relative power of the illuminant, 1 at its largest. */
  illuminant: Float64Array
  relief: Relief | null
}

/** Addresses of the tables; null for those that a surface has none of. */
interface Addresses {
  lobes: string
  /** Folder of the maps whose illuminants are known. */
  known: string
  metals: string
  profile: string | null
  relief: string | null
}

let last: { key: string; tables: Promise<SpectralTables> } | null = null

/** Loads the tables that a material reads; those that it has loaded already are shared with it, the last are kept. */
export function loadTables(subject: Subject): Promise<SpectralTables> {
  const addresses = addressesOf(subject)
  const key = JSON.stringify(addresses)
  if (last?.key !== key) {
    const tables = load(addresses)
    const own = (last = { key, tables })
    // What failed may be tried again.
    tables.catch(() => {
      if (last === own) last = null
    })
  }
  return last.tables
}

function addressesOf({ surface, material }: Subject): Addresses {
  const { mapsPath } = material
  const { lobes, metals } = spectrumUrls(material, mapsPath)
  const isRelief = surface instanceof HeightField
  return {
    ...{ lobes, metals },
    known: mapsPath,
    profile: isRelief ? null : profileUrl('inspector', surface.profile, mapsPath),
    relief: isRelief
      ? `${surface.field.includes('/') ? '' : `${mapsPath}height-field-`}${surface.field}-jacobi-anger`
      : null,
  }
}

async function load(addresses: Addresses): Promise<SpectralTables> {
  const map = (url: string | null): Promise<LoadedMap | null> =>
    url === null ? Promise.resolve(null) : loadSharedMap(url)
  const [lobes, metals, profile, relief] = await Promise.all([
    loadSharedMap(addresses.lobes),
    loadSharedMap(addresses.metals),
    map(addresses.profile),
    map(addresses.relief),
  ])
  const spectrum = new LightSpectrum(lobes)
  return {
    maps: { lobes, metals, profile, relief },
    spectrum,
    illuminant: await illuminantOf(lobes, spectrum, addresses.known),
    relief: relief === null ? null : new Relief(relief),
  }
}

/** The illuminant of a map of kind 'lobes', relative to A's for the observer of 1931, to D65's for others. */
async function illuminantOf(
  lobes: LoadedMap,
  spectrum: LightSpectrum,
  mapsPath: string,
): Promise<Float64Array> {
  const { observer } = lobes.sidecar.recipe
  const load = async (name: string): Promise<LightSpectrum> =>
    new LightSpectrum(await loadSharedMap(`${mapsPath}lobes-${name}`))
  const a = await load('1931-2-A')
  const powerOfA = a.wavelengths.map(illuminantA)
  if (observer === '1931-2') return illuminantSpectrum(spectrum, a, powerOfA)
  const powerOfD65 = illuminantSpectrum(await load('1931-2-D65'), a, powerOfA)
  return illuminantSpectrum(spectrum, await load(`${String(observer)}-D65`), powerOfD65)
}

/** t, b, n in the world, orthonormal. */
export type Axes = [t: Vector3, b: Vector3, n: Vector3]

/** Everything that the pictures of one point are made from. */
export interface PointOptics {
  tables: SpectralTables
  surface: Foil | Grating | HeightField
  point: PickedPoint
  frame: PointFrame
  /** Axes t, b, n of the grating, or of the relief's patch, in the world. */
  axes: Axes
  /** ω_i to the flash and ω_o to the camera, in these axes. */
  wi: Direction
  wo: Direction
  /** The flash' irradiance on a plane that faces it, and its standard deviation, rad. */
  irradiance: number
  angularRadius: number
  /** The lacquer, if there is one: its normal is the mesh's, whatever bumps do below it. */
  lacquer: { coat: Coat; axes: Axes; wi: Direction; wo: Direction } | null
  /** Whether the mesh turns this side to the camera. */
  isSeen: boolean
  /** Share of the light that passes the lacquer from the flash, and from all sides. */
  through: { flash: number; environment: number }
  /** Albedo of the matt base where nothing diffracts, linear sRGB. */
  albedo: Colour
  strength: number
  /** One of the two. Neither where nothing diffracts. */
  grating: { at: GratingAt; optics: GratingOptics | null } | null
  relief: ReliefOptics | null
}

/** What shines on the point, and from where it is seen. */
export interface Situation {
  eye: Vector3
  flash: { position: Vector3; intensity: number; angularRadius: number }
}

export function pointOptics(
  { surface, material }: Subject,
  tables: SpectralTables,
  point: PickedPoint,
  frame: PointFrame,
  { eye, flash }: Situation,
): PointOptics {
  const at = surface instanceof HeightField ? null : gratingAt(surface, point.uv.x, point.uv.y)
  const flat: Axes = [frame.tangent, frame.bitangent, frame.normal]
  const axes = turned(
    surface instanceof Foil && surface.hasBumps ? bentFrame(flat, surface, point.uv) : flat,
    surface instanceof HeightField ? surface.orientation : at!.orientation,
  )
  const toFlash = flash.position.clone().sub(frame.position)
  const toEye = eye.clone().sub(frame.position).normalize()
  // As three's point lights fall off.
  const irradiance = flash.intensity / Math.max(toFlash.lengthSq(), 0.01)
  toFlash.normalize()
  const widening = { coherence: material.coherence, roughness: material.roughness }
  const lacquer = lacquerOf(material, flat, toFlash, toEye)
  const passing =
    lacquer && [lacquer.wi, lacquer.wo].map((way) => coatPassing(lacquer.coat, way[2]))
  return {
    ...{ tables, surface, point, frame, axes, irradiance, lacquer },
    wi: within(axes, toFlash),
    wo: within(axes, toEye),
    isSeen: toEye.dot(frame.normal) > 0,
    angularRadius: flash.angularRadius,
    through: {
      flash: passing === null ? 1 : passing[0]! * passing[1]!,
      environment: passing === null ? 1 : passing[1]! ** 2,
    },
    albedo: baseColor(material, point).toArray() as Colour,
    strength: at?.strength ?? (surface as HeightField).strength,
    grating: at && {
      at,
      optics: gratingOptics(surface as Foil | Grating, material, tables, at, widening),
    },
    relief:
      tables.relief && surface instanceof HeightField
        ? {
            ...widening,
            relief: tables.relief,
            reflectance: reliefReflectance(surface, material, tables),
            isRelative: material.energy === 'relative',
          }
        : null,
  }
}

function gratingOptics(
  surface: Foil | Grating,
  { metal, energy }: DiffractionMaterial,
  { maps }: SpectralTables,
  { period }: GratingAt,
  widening: { coherence: number; roughness: number },
): GratingOptics | null {
  if (period === null) return null
  const longest = surface instanceof Foil ? surface.period[1] : period
  return {
    ...widening,
    ...{ period, height: surface.height, energy },
    efficiency: efficiencyOf(maps.profile!),
    maxOrder: maxOrder(maps.profile!, longest, surface.height),
    reflectance: metalReflectance(maps.metals, metal),
  }
}

function reliefReflectance(
  { ior }: HeightField,
  { metal, energy }: DiffractionMaterial,
  { maps }: SpectralTables,
): ReliefOptics['reflectance'] {
  const isRelative = energy === 'relative'
  if (ior === null) return isRelative ? () => 1 : metalReflectance(maps.metals, metal)
  const flat = isRelative ? fresnel(1, ior) : 1
  return (_, wi, wo) => {
    const cosine = wi[0] * wo[0] + wi[1] * wo[1] + wi[2] * wo[2]
    return fresnel(Math.sqrt(Math.max(0.5 + 0.5 * cosine, 0)), ior) / flat
  }
}

function lacquerOf(
  { coat, coatIor, coatRoughness }: DiffractionMaterial,
  axes: Axes,
  toFlash: Vector3,
  toEye: Vector3,
): PointOptics['lacquer'] {
  if (coat === 0) return null
  return {
    coat: { share: coat, ior: coatIor, alpha: coatRoughness ** 2 },
    axes,
    wi: within(axes, toFlash),
    wo: within(axes, toEye),
  }
}

/** The matt base's albedo, of scales the instance's own. */
function baseColor({ color }: DiffractionMaterial, { mesh, instance }: PickedPoint): Color {
  const base = color.clone()
  if (!(mesh instanceof InstancedMesh) || mesh.instanceColor === null) return base
  const own = new Color()
  mesh.getColorAt(instance, own)
  return base.multiply(own)
}

/** The frame turned about its normal, tangent towards bitangent. */
function turned([tangent, bitangent, normal]: Axes, angle: number): Axes {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)]
  return [
    tangent.clone().multiplyScalar(cos).addScaledVector(bitangent, sin),
    bitangent.clone().multiplyScalar(cos).addScaledVector(tangent, -sin),
    normal,
  ]
}

function within(axes: Axes, direction: Vector3): Direction {
  return [direction.dot(axes[0]), direction.dot(axes[1]), direction.dot(axes[2])]
}
