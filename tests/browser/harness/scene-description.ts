import type {
  DiffractionMaterialOptions,
  GratingOptions,
  HeightFieldOptions,
  ProgressiveRefinementOptions,
} from '../../../web'

type Triple = [number, number, number]

/** A scene as written in tests/scenes/*.json; the README there says what each field means. */
export interface SceneDescription {
  size: [number, number]
  camera: { position: Triple; target?: Triple; up?: Triple; fov_deg: number }
  mesh: MeshDescription
  surface: SurfaceDescription
  material?: MaterialDescription
  lights?: LightDescription[]
  environment?: EnvironmentDescription
  force?: ForcedParts
  /** The mean of many frames in place of one. */
  refinement?: ProgressiveRefinementOptions
}

/** What is put into the material's program though the scene has no use for it. */
export interface ForcedParts {
  /** Over those that the material chose. */
  defines?: Record<string, string>
  /** More lights, of next to no intensity. */
  lights?: LightDescription[]
  /** In place of none, of no intensity. */
  environment?: EnvironmentDescription
  /** The normal map of a flat surface. */
  normalMap?: true
}

export type MeshDescription = (
  | { kind: 'plane'; size: [number, number] }
  | { kind: 'sphere'; radius: number }
  | { kind: 'disc'; inner: number; outer: number }
  /** Radius and height along a curve through these points, from the lowest. */
  | { kind: 'lathe'; outline: [number, number][] }
) & {
  position?: Triple
  rotation_deg?: Triple
  scale?: Triple
  /** Whether the geometry brings tangents, or the shader finds them. */
  tangents?: boolean
  /** Texture coordinates that do not vary, where a surface has no direction of its own. */
  constantUv?: boolean
  side?: 'front' | 'back' | 'double'
}

export type SurfaceDescription =
  | ({ kind: 'grating' } & GratingOptions)
  | ({ kind: 'height-field' } & HeightFieldOptions)
  | { kind: 'foil'; map: string; repeat?: [number, number]; height?: number; filtered?: boolean }

export type MaterialDescription = Omit<
  DiffractionMaterialOptions,
  'surface' | 'color' | 'normalScale' | 'envMap' | 'map' | 'normalMap' | 'bumpMap' | 'onError'
> & { color?: Triple }

export type LightDescription =
  | {
      kind: 'directional'
      direction: Triple
      color?: Triple
      intensity?: number
      angularRadius?: number
    }
  | {
      kind: 'point'
      position: Triple
      color?: Triple
      intensity?: number
      decay?: number
      distance?: number
      angularRadius?: number
    }
  | {
      kind: 'spot'
      position: Triple
      target?: Triple
      color?: Triple
      intensity?: number
      decay?: number
      distance?: number
      angle_deg: number
      penumbra?: number
      angularRadius?: number
    }

export type EnvironmentDescription = (
  { constant: Triple } | { asset: string } | { equirect: string }
) & {
  intensity?: number
  rotation_deg?: Triple
}
