import { Vector2, Vector3 } from 'three'
import gratingGlsl from '../../shaders/surfaces/grating.glsl?raw'
import { oneOf, positive, within } from '../validation.ts'
import { GratingSurface } from './grating-surface.ts'
import type { OpticsSettings } from './surface.ts'

export const TRACKS = ['straight', 'circular'] as const
export type Tracks = (typeof TRACKS)[number]

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
  readonly glsl = gratingGlsl
  defines: Record<string, string | number> = {}
  readonly uniforms = {
    uGratingFrequency: { value: 1 },
    uGratingDirection: { value: new Vector2(1, 0) },
    uGratingStrength: { value: 1 },
  }
  #period = 1
  #orientation = 0
  #tracks: Tracks = 'straight'
  readonly #planar = [new Vector3()]

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

  measuredAs({ roughness }: OpticsSettings): string {
    return roughness > 0 ? 'rough grating' : 'grating'
  }

  get isPartial(): boolean {
    return this.strength < 1
  }

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
