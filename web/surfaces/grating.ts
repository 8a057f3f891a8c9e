import { Vector2, Vector3 } from 'three'
import gratingGlsl from '../../shaders/surfaces/grating.glsl?raw'
import { oneOf, positive, within } from '../validation.ts'
import { GratingSurface } from './grating-surface.ts'
import type { OpticsSettings } from './surface.ts'

export const TRACKS = ['straight', 'circular'] as const
/** How grooves run: in parallel, or in circles about the middle of the uv square. */
export type Tracks = (typeof TRACKS)[number]

/** What a {@link Grating} is made of. */
export interface GratingOptions {
  /** Distance from groove to groove, µm. */
  period: number
  /** Height of the relief, µm. */
  height: number
  /** 'sinusoidal' (default), 'rectangular', 'blazed', 'triangular', 'sampled', or a map's address. */
  profile?: string
  /** Angle from growing u (circular tracks: from the radius) to the grating vector, rad; 0 by default. */
  orientation?: number
  /** Straight grooves (default), or circles about the middle of the uv square, as on a disc. */
  tracks?: Tracks
  /** Share of the surface that diffracts, 0 to 1 (default); the rest shows the matt base. */
  strength?: number
}

/** One grating over the whole surface. */
export class Grating extends GratingSurface {
  /** The GLSL of its point: one grating, wherever. */
  readonly glsl = gratingGlsl
  /** Defines that belong to the surface itself. */
  defines: Record<string, string | number> = {}
  /** Uniforms that belong to the surface itself; shared by all materials that show it. */
  readonly uniforms = {
    uGratingFrequency: { value: 1 },
    uGratingDirection: { value: new Vector2(1, 0) },
    uGratingStrength: { value: 1 },
  }
  #period = 1
  #orientation = 0
  #tracks: Tracks = 'straight'
  readonly #planar = [new Vector3()]

  /** @param options - throws a DiffractionError where one is out of range */
  constructor(options: GratingOptions) {
    super('Grating', options.height, options.profile ?? 'sinusoidal')
    this.period = options.period
    this.orientation = options.orientation ?? 0
    this.tracks = options.tracks ?? 'straight'
    this.strength = options.strength ?? 1
  }

  /** Distance from groove to groove, µm. */
  get period(): number {
    return this.#period
  }

  set period(value: number) {
    this.#period = positive(this.name, 'period', value, 'µm')
    this.uniforms.uGratingFrequency.value = 1 / value
    // The number of orders that can propagate goes with the period.
    this.changed()
  }

  /** Angle from growing u (circular tracks: from the radius) to the grating vector, rad. */
  get orientation(): number {
    return this.#orientation
  }

  set orientation(value: number) {
    this.#orientation = within(this.name, 'orientation', value, -Infinity, Infinity, 'rad')
    this.uniforms.uGratingDirection.value.set(Math.cos(value), Math.sin(value))
  }

  /** Straight grooves, or circles about the middle of the uv square. */
  get tracks(): Tracks {
    return this.#tracks
  }

  set tracks(value: Tracks) {
    this.#tracks = oneOf(this.name, 'tracks', value, TRACKS)
    this.defines = value === 'circular' ? { TRACKS_CIRCULAR: '' } : {}
    this.changed()
  }

  /** Share of the surface that diffracts, 0 to 1. */
  get strength(): number {
    return this.uniforms.uGratingStrength.value
  }

  set strength(value: number) {
    const wasPartial = this.isPartial
    this.uniforms.uGratingStrength.value = within(this.name, 'strength', value, 0, 1)
    if (this.isPartial !== wasPartial) this.changed()
  }

  /** The class of surfaces as which the report measures it: rough or not. */
  measuredAs({ roughness }: OpticsSettings): string {
    return roughness > 0 ? 'rough grating' : 'grating'
  }

  /** Whether the strength is below 1, so that the matt base shows through. */
  get isPartial(): boolean {
    return this.strength < 1
  }

  /** The one grating, (cos θ, sin θ, frequency in 1/µm), where tracks are straight; else null. */
  get planarGratings(): readonly Vector3[] | null {
    if (this.#tracks !== 'straight') return null
    const { uGratingDirection, uGratingFrequency } = this.uniforms
    this.#planar[0]!.set(...uGratingDirection.value.toArray(), uGratingFrequency.value)
    return this.#planar
  }

  protected readonly mapRead = { included: false, why: 'they are the same everywhere' }

  protected get periodRange(): readonly [number, number] {
    return [this.#period, this.#period]
  }
}
