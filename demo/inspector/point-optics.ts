import { Foil, Grating, HeightField, type DiffractionMaterial } from '../../web'
import { Color, InstancedMesh, type Vector3 } from 'three'
import { loadSharedMap } from '../../web/maps/cache'
import type { LoadedMap } from '../../web/maps/load'
import { maxOrder } from '../../web/spectrum/max-order'
import { metalReflectance } from '../../web/spectrum/metal-reflectance'
import { profileUrl } from '../../web/surfaces/profile'
import { spectrumUrls } from '../../web/spectrum/spectrum-maps'
import type { Subject } from '../subjects/subject'
import { efficiencyOf } from './optics/efficiency'
import type { GratingOptics } from './optics/grating-brdf'
import { gratingAt, type GratingAt } from './optics/grating-at'
import { LightSpectrum, illuminantSpectrum } from './optics/light-spectrum'
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
  /** Of the same observer and illuminant A; null where that is the illuminant. */
  a: string | null
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
  const { mapsPath, illuminant, observer } = material
  const { lobes, metals } = spectrumUrls(material, mapsPath)
  const isRelief = surface instanceof HeightField
  return {
    ...{ lobes, metals },
    a: illuminant === 'A' ? null : `${mapsPath}lobes-${observer}-A`,
    profile: isRelief ? null : profileUrl('inspector', surface.profile, mapsPath),
    relief: isRelief
      ? `${surface.field.includes('/') ? '' : `${mapsPath}height-field-`}${surface.field}-jacobi-anger`
      : null,
  }
}

async function load(addresses: Addresses): Promise<SpectralTables> {
  const map = (url: string | null): Promise<LoadedMap | null> =>
    url === null ? Promise.resolve(null) : loadSharedMap(url)
  const [lobes, metals, a, profile, relief] = await Promise.all([
    loadSharedMap(addresses.lobes),
    loadSharedMap(addresses.metals),
    map(addresses.a),
    map(addresses.profile),
    map(addresses.relief),
  ])
  const spectrum = new LightSpectrum(lobes)
  return {
    maps: { lobes, metals, profile, relief },
    spectrum,
    illuminant: illuminantSpectrum(spectrum, a === null ? spectrum : new LightSpectrum(a)),
    relief: relief === null ? null : new Relief(relief),
  }
}

/** Everything that the pictures of one point are made from. */
export interface PointOptics {
  tables: SpectralTables
  surface: Foil | Grating | HeightField
  point: PickedPoint
  frame: PointFrame
  /** Axes t, b, n of the grating, or of the relief's patch, in the world. */
  axes: [t: Vector3, b: Vector3, n: Vector3]
  /** ω_i to the flash and ω_o to the camera, in these axes. */
  wi: Direction
  wo: Direction
  /** The flash' irradiance on a plane that faces it, and its standard deviation, rad. */
  irradiance: number
  angularRadius: number
  /** Share of the light that passes the lacquer from the flash, and from all sides. */
  through: { flash: number; environment: number }
  /** What the matt base returns of the flash where nothing diffracts, linear sRGB. */
  base: [number, number, number]
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
  const turn = surface instanceof HeightField ? surface.orientation : at!.orientation
  const axes = turned(frame, turn)
  const toFlash = flash.position.clone().sub(frame.position)
  const distance2 = toFlash.lengthSq()
  const wi = within(axes, toFlash.normalize())
  const wo = within(axes, eye.clone().sub(frame.position).normalize())
  const widening = { coherence: material.coherence, roughness: material.roughness }
  // As three's point lights fall off.
  const irradiance = flash.intensity / Math.max(distance2, 0.01)
  const cosine = Math.max(wi[2], 0)
  const passing = [coatPassing(material, wi[2]), coatPassing(material, wo[2])] as const
  return {
    ...{ tables, surface, point, frame, axes, wi, wo, irradiance },
    angularRadius: flash.angularRadius,
    through: { flash: passing[0] * passing[1], environment: passing[1] ** 2 },
    base: matt(baseColor(material, point), (irradiance * cosine) / Math.PI),
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

/** Reflectance of a smooth dielectric for unpolarised light: Fresnel's equations. */
function fresnel(cosine: number, ior: number): number {
  const inside = Math.sqrt(ior ** 2 - 1 + cosine ** 2)
  const s = (cosine - inside) / (cosine + inside)
  const p = (ior ** 2 * cosine - inside) / (ior ** 2 * cosine + inside)
  return (s * s + p * p) / 2
}

/** Share of light that passes the lacquer once. */
function coatPassing({ coat, coatIor }: DiffractionMaterial, cosine: number): number {
  return coat === 0 ? 1 : 1 - coat * fresnel(Math.min(Math.max(cosine, 0), 1), coatIor)
}

/** The matt base's albedo, of scales the instance's own. */
function baseColor({ color }: DiffractionMaterial, { mesh, instance }: PickedPoint): Color {
  const base = color.clone()
  if (!(mesh instanceof InstancedMesh) || mesh.instanceColor === null) return base
  const own = new Color()
  mesh.getColorAt(instance, own)
  return base.multiply(own)
}

function matt({ r, g, b }: Color, factor: number): [number, number, number] {
  return [r * factor, g * factor, b * factor]
}

/** The frame turned about its normal, tangent towards bitangent. */
function turned({ tangent, bitangent, normal }: PointFrame, angle: number): PointOptics['axes'] {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)]
  return [
    tangent.clone().multiplyScalar(cos).addScaledVector(bitangent, sin),
    bitangent.clone().multiplyScalar(cos).addScaledVector(tangent, -sin),
    normal,
  ]
}

function within(axes: PointOptics['axes'], direction: Vector3): Direction {
  return [direction.dot(axes[0]), direction.dot(axes[1]), direction.dot(axes[2])]
}
