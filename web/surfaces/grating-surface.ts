import type { IUniform, Vector3 } from 'three'
import { refuse } from '../errors.ts'
import { gratingShaders } from '../glsl/grating-shaders.ts'
import { constantOf, expectKinds, type LoadedMap } from '../maps/load.ts'
import { gratingOptics } from '../spectrum/grating-optics.ts'
import { SHORTEST_WAVELENGTH } from '../spectrum/max-order.ts'
import { spectrumUrls } from '../spectrum/spectrum-maps.ts'
import { positive } from '../validation.ts'
import { profileUrl } from './profile.ts'
import type { Method, Optics, OpticsSettings, Surface } from './surface.ts'

/** What gratings and maps of gratings have in common: one profile, one height, and a range of periods. */
export abstract class GratingSurface implements Surface {
  abstract readonly glsl: string
  abstract readonly defines: Record<string, string | number>
  abstract readonly uniforms: Record<string, IUniform>
  abstract readonly isPartial: boolean
  abstract measuredAs(settings: OpticsSettings): string
  /** Why the map of a foil is, or is not, read for its gratings' orientation and period. */
  protected abstract readonly mapRead: { included: boolean; why: string }
  abstract readonly planarGratings: readonly Vector3[] | null
  /** Shortest and longest period on the surface, µm. */
  protected abstract readonly periodRange: readonly [number, number]
  /** How far the frequencies of gratings that are shown as one are off its own at most, 1/µm. */
  protected readonly frequencyReach: number = 0

  readonly glslFiles = gratingShaders
  readonly methods = ['closed-form', 'wavelength-loop'] as const
  readonly energies = ['conserving', 'reciprocal', 'kirchhoff'] as const
  #version = 0
  #height: number
  #profile: string
  /** The largest phase of the profile's table, rad; known once a material has loaded it. */
  #maxPhase = Infinity

  /**
   * @param name - the class', for errors and reports
   * @param height - of the relief, µm
   * @param profile - a baked profile's name, or a map's address
   */
  constructor(
    readonly name: string,
    height: number,
    profile: string,
  ) {
    this.#height = positive(name, 'height', height, 'µm')
    profileUrl(name, profile, '')
    this.#profile = profile
  }

  get version(): number {
    return this.#version
  }

  /** Height h0 of the relief from its lowest to its highest point, µm. */
  get height(): number {
    return this.#height
  }

  set height(value: number) {
    this.#checkPhase(positive(this.name, 'height', value, 'µm'))
    this.#height = value
    this.changed()
  }

  /** A baked profile's name, or the address of a map of kind 'profile' without extension. */
  get profile(): string {
    return this.#profile
  }

  set profile(value: string) {
    profileUrl(this.name, value, '')
    if (value === this.#profile) return
    this.#profile = value
    // Another table may reach further, or less far; its own check follows when it is loaded.
    this.#maxPhase = Infinity
    this.changed()
  }

  tables(settings: OpticsSettings, mapsPath: string): Record<string, string> {
    return {
      profile: profileUrl(this.name, this.#profile, mapsPath),
      ...spectrumUrls(settings, mapsPath),
    }
  }

  /** All methods read the same tables. */
  methodsKnown(): readonly Method[] {
    return []
  }

  optics(tables: Record<string, LoadedMap>, settings: OpticsSettings): Optics {
    const { profile, lobes, metals } = expectKinds(this.name, tables, {
      profile: 'profile',
      lobes: 'lobes',
      metals: 'metals',
    })
    this.#maxPhase = constantOf(profile, 'max_phase')[0]!
    this.#checkPhase(this.#height)
    const optics = gratingOptics(
      { profile, lobes, metals },
      {
        ...settings,
        height: this.#height,
        period: this.periodRange,
        frequencyReach: this.frequencyReach,
      },
    )
    return {
      ...optics,
      features: [
        ...optics.features,
        { feature: 'orientation and period from a map', ...this.mapRead },
      ],
    }
  }

  /** To be called after a change that reaches beyond the surface's own uniforms. */
  protected changed(): void {
    this.#version++
  }

  /** φ = 2π w h0 / λ is largest at the shortest wavelength and at w = 2, light and viewer both on the normal. */
  #checkPhase(height: number): void {
    const highest = (this.#maxPhase * SHORTEST_WAVELENGTH) / (4 * Math.PI)
    if (height > highest)
      refuse(
        this.name,
        'height',
        height,
        `at most ${highest.toPrecision(4)} µm, which the table of profile '${this.#profile}' covers`,
      )
  }
}
