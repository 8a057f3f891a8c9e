import type { Color, ColorRepresentation, Euler, MaterialParameters, Texture, Vector2 } from 'three'
import type { DiffractionError } from '../errors.ts'
import type { LoadedMap } from '../maps/load.ts'
import {
  EFFICIENCIES,
  ENERGIES,
  METALS,
  METHODS,
  OBSERVERS,
  type OpticsSettings,
  type Surface,
} from '../surfaces/surface.ts'
import { oneOf, positive, within } from '../validation.ts'

/** The settings that a material chooses by itself where it is given a largest error. */
export const CHOSEN_SETTINGS = [
  'method',
  'efficiencies',
  'wavelengthStep',
  'environmentNodes',
] as const
export type ChosenSettings = Pick<OpticsSettings, (typeof CHOSEN_SETTINGS)[number]>

export const GAMUTS = ['map', 'signed'] as const
/** Whether colours are moved into the display's gamut, or left as the sums that they are. */
export type Gamut = (typeof GAMUTS)[number]

/** What a DiffractionMaterial is made of; beside these, the parameters of every three material. */
export interface DiffractionMaterialOptions extends MaterialParameters, Partial<OpticsSettings> {
  /** What diffracts: a Grating, a Foil, a HeightField. */
  surface: Surface
  /**
   * Largest relative root mean square error of radiance. Method and knobs that were not given are then chosen: the fastest
   * that erred by no more in the report's scenes of such a surface. Null (default): as given.
   */
  maxError?: number | null
  /** Folder of the baked tables, with its slash; 'maps/baked/' by default. */
  mapsPath?: string
  /**
   * Maps that are taken in the place of what their addresses would fetch: profile, illuminant and field can then be addresses
   * of these.
   */
  maps?: Readonly<Record<string, LoadedMap>>
  /** Whether the surface diffracts at all; true by default. */
  diffraction?: boolean
  /** Radius (standard deviation, rad) of lights that state none in `userData.angularRadius`; null, points, by default. */
  lightAngularRadius?: number | null
  /** Share of the surface under a clear lacquer, 0 (default) to 1. */
  coat?: number
  /** The lacquer's refractive index, 1.5 by default. */
  coatIor?: number
  /** The lacquer's roughness as three counts it, 0 (default) to 1. */
  coatRoughness?: number
  /** Albedo of the matt base that shows where the surface does not diffract; white by default. */
  color?: ColorRepresentation | Color
  /** Colours of the matt base, times `color`. */
  map?: Texture | null
  /** Normals in the tangent frame. */
  normalMap?: Texture | null
  /** How far the normal map bends normals, along u and along v: a factor each, 1 by default. */
  normalScale?: Vector2
  /** Heights that bend normals. */
  bumpMap?: Texture | null
  /** How far the bump map bends normals: a factor as in three, 1 by default. */
  bumpScale?: number
  /** Normals from the triangles instead of the vertices; false by default. */
  flatShading?: boolean
  /** The environment, in place of the scene's. */
  envMap?: Texture | null
  /** Factor of the radiance of `envMap`, 1 by default. */
  envMapIntensity?: number
  /** How `envMap` is turned, rad. */
  envMapRotation?: Euler
  /**
   * Whether a flat mesh under an environment may read a table in place of the nodes, true by default: where it is flat,
   * rough enough and at rest.
   */
  planarEnvironment?: boolean
  /** 'map' (default) moves colours into the display's gamut; 'signed' leaves sums as they are, to be read back. */
  gamut?: Gamut
  /** Told of tables that could not be loaded; prints to the console by default. */
  onError?: (error: DiffractionError) => void
}

export const DEFAULT_SETTINGS: Readonly<OpticsSettings> = {
  metal: 'aluminium',
  illuminant: 'D65',
  observer: '1931-2',
  energy: 'conserving',
  method: 'closed-form',
  wavelengthStep: 0.005,
  efficiencies: 'table',
  coherence: 16.25,
  roughness: 0,
  environmentNodes: 12,
}

/** One check for each setting; each returns the value or throws a DiffractionError that names its owner and it. */
export const SETTING_CHECKS: {
  [K in keyof OpticsSettings]: (owner: string, value: unknown) => OpticsSettings[K]
} = {
  metal: (owner, value) => oneOf(owner, 'metal', value, METALS),
  // Any name: which illuminants there are is a question of which maps were baked.
  illuminant: (owner, value) =>
    typeof value === 'string' && value !== '' ? value : oneOf(owner, 'illuminant', value, ['D65']),
  observer: (owner, value) => oneOf(owner, 'observer', value, OBSERVERS),
  energy: (owner, value) => oneOf(owner, 'energy', value, ENERGIES),
  method: (owner, value) => oneOf(owner, 'method', value, METHODS),
  // Above 50 nm the loop would step over a colour-matching lobe; below 0.1 nm it would never end.
  wavelengthStep: (owner, value) => within(owner, 'wavelengthStep', value, 0.0001, 0.05, 'µm'),
  efficiencies: (owner, value) => oneOf(owner, 'efficiencies', value, EFFICIENCIES),
  coherence: (owner, value) => positive(owner, 'coherence', value, 'µm'),
  roughness: (owner, value) => within(owner, 'roughness', value, 0, Math.PI / 2, 'rad'),
  // 401 are the spectra's own nanometres; more would only repeat them.
  environmentNodes: (owner, value) => Math.round(within(owner, 'environmentNodes', value, 1, 401)),
}
