import type { IUniform, Vector3 } from 'three'
import type { LoadedMap } from '../maps/load.ts'
import type { RefinementFrame } from '../refinement/refinement-frame.ts'

export const METALS = ['aluminium', 'silver', 'gold', 'copper'] as const
/** What reflects, by its measured refractive indices. */
export type Metal = (typeof METALS)[number]

export const ENERGIES = ['conserving', 'reciprocal', 'kirchhoff', 'relative'] as const
/** How light is normalised over the directions into which it goes: docs/theory/gratings.md and height-fields.md. */
export type Energy = (typeof ENERGIES)[number]

export const METHODS = [
  'closed-form',
  'wavelength-loop',
  'line-sum',
  'baked',
  'jacobi-anger',
  'taylor',
] as const
/** By which method light is summed over wavelengths and orders. */
export type Method = (typeof METHODS)[number]

export const EFFICIENCIES = ['table', 'taylor'] as const
/** Where the wavelength loop has efficiencies from: the profile's table, or the papers' Taylor series. */
export type Efficiencies = (typeof EFFICIENCIES)[number]

export const OBSERVERS = ['1931-2', '2015-2'] as const
/** Whose colour-matching functions: CIE 1931 or 2015, 2 degrees. */
export type Observer = (typeof OBSERVERS)[number]

/** What a material asks of any surface's optics. */
export interface OpticsSettings {
  /** What reflects, where the surface is no dielectric of its own. */
  metal: Metal
  /** A spectrum for which there is a map of lobes: 'D65', 'A', 'inverse-A', 'LED-B1' … */
  illuminant: string
  /** Whose colour-matching functions make colours of spectra. */
  observer: Observer
  /** How light is normalised over the directions into which it goes; one of the surface's `energies`. */
  energy: Energy
  /** By which method light is summed; one of the surface's `methods`. */
  method: Method
  /** Step of the wavelength loop, µm. */
  wavelengthStep: number
  /** Where the wavelength loop has efficiencies from. */
  efficiencies: Efficiencies
  /** Standard deviation σ of the coherence window, µm. */
  coherence: number
  /** Standard deviation of the surface's tilt, rad. */
  roughness: number
  /** Number of nodes at which an order's arc of the environment is sampled. */
  environmentNodes: number
}

/** One thing the shader can do, whether it is compiled in, and why. */
export interface Feature {
  /** What it is, in words. */
  feature: string
  /** Whether it is compiled in. */
  included: boolean
  /** The reason, in words. */
  why: string
}

/** What lights ask of the optics: defines that are in or out, and why. */
export interface LightOptics {
  /** Defines of the program, true where they are in. */
  defines: Record<string, boolean>
  /** What that means, and why. */
  features: readonly Feature[]
}

/** An environment is read at other places in each frame of a progressive refinement. */
export interface EnvironmentRefinement {
  /**
   * Makes uniforms that serve all of so many frames, and those that stand alone too, in place of those of the same name; asked
   * for with the first.
   */
  uniforms: (count: number) => Record<string, IUniform>
  /** Index of the first node that a frame reads, the uniform uEnvironmentStart; 0 in one that stands alone. */
  start: (frame: RefinementFrame) => number
}

/** What a surface adds to the shader program once its tables are there. */
export interface Optics {
  /** What of the optics is in the program, what is left out, and why. */
  features: readonly Feature[]
  /** What of it only an environment asks for. */
  environmentFeatures: readonly Feature[]
  /** Defines of the program. */
  defines: Record<string, string | number>
  /** Uniforms of the program, tables among them. */
  uniforms: Record<string, IUniform>
  /** Makes the uniforms that an environment needs besides; asked for once there is one. */
  environmentUniforms: () => Record<string, IUniform>
  /** How it is read in the frames of a progressive refinement; null: as in any other. */
  environmentRefinement: EnvironmentRefinement | null
  /** Whether it reads the environment blurred for its roughness: shaders/blurred-environment.glsl. */
  blursEnvironment: boolean
  /** What of the optics depends on the largest angular radius of the lights in the scene, rad. */
  underLights: (angularRadius: number) => LightOptics
  /**
   * Does what takes long, in between frames, before the optics are used; rejects with a DiffractionError where a table does not
   * serve. Returns null where all is done; absent where nothing takes long.
   *
   * @param isWanted - asked every now and then: false leaves the rest undone, and the promise resolves
   */
  prepare?: (isWanted: () => boolean) => Promise<void> | null
}

/**
 * A surface answers two questions, in one GLSL interface: the radiance from a light and the radiance from the
 * environment. The material composes the answers and knows no optics; a surface knows none of three's lights.
 */
export interface Surface {
  /** A short name for reports, such as 'grating'. */
  readonly name: string
  /** The methods by which it can be drawn, its default first. */
  readonly methods: readonly Method[]
  /** The ways in which its light can be normalised, its default first. */
  readonly energies: readonly Energy[]
  /**
   * GLSL that defines `surfacePointAt` and, where DIFFRACTION is defined, `surfaceRadianceFromLight` and
   * `surfaceRadianceFromEnvironment`.
   */
  readonly glsl: string
  /** The files that this GLSL includes, by the name it uses. */
  readonly glslFiles: Record<string, string>
  /** Defines that belong to the surface itself. */
  readonly defines: Record<string, string | number | boolean>
  /** Uniforms that belong to the surface itself; shared by all materials that show it. */
  readonly uniforms: Record<string, IUniform>
  /** The class of surfaces as which the report measures it under these settings: web/materials/measured-errors.json. */
  measuredAs(settings: OpticsSettings): string
  /** Whether the strength is below one anywhere, so that the matt base shows through. */
  readonly isPartial: boolean
  /**
   * cos θ, sin θ and frequency (1/µm) of the gratings that all of the surface is made of, in the order of the layers that
   * its GLSL reads where PLANAR_TEXELS is defined; null where they turn or lean from place to place, or are no gratings.
   */
  readonly planarGratings: readonly Vector3[] | null
  /** Counts the changes that reach beyond `uniforms`: materials compare it before they render. */
  readonly version: number
  /**
   * The addresses of the tables that the optics need, by a name of the surface's own.
   *
   * @param mapsPath - folder of the baked tables, with its slash
   */
  tables(settings: OpticsSettings, mapsPath: string): Record<string, string>
  /**
   * Methods that can be drawn under these settings by maps that are known to be there, besides those that read the same
   * tables.
   */
  methodsKnown(settings: OpticsSettings): readonly Method[]
  /**
   * Defines and uniforms for those tables; throws a DiffractionError if they do not cover the surface.
   *
   * @param tables - the maps at those addresses, by the same names
   */
  optics(tables: Record<string, LoadedMap>, settings: OpticsSettings): Optics
}
