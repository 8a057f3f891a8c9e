import { Vector2, type IUniform } from 'three'
import heightFieldGlsl from '../../shaders/surfaces/height-field.glsl?raw'
import { refuse } from '../errors.ts'
import { heightFieldShaders } from '../glsl/height-field-shaders.ts'
import { expectKinds, type LoadedMap } from '../maps/load.ts'
import { unlikeBaked } from '../height-field/baked-pattern.ts'
import { heightFieldOptics } from '../height-field/optics.ts'
import { spectrumUrls } from '../spectrum/spectrum-maps.ts'
import { within } from '../validation.ts'
import type { Tiles } from '../height-field/cut-window.ts'
import type { Method, Optics, OpticsSettings, Surface } from './surface.ts'

/** Which relief, and how it lies. */
export interface HeightFieldOptions {
  /**
   * A baked field's name, as in 'bumps', or the address of one without its method, as in
   * 'maps/baked/height-field-bumps'.
   */
  field: string
  /** Angle from growing u to the patch's x axis, rad; 0 by default. */
  orientation?: number
  /** Share of the surface that diffracts, 0 to 1 (default); the rest shows the matt base. */
  strength?: number
  /** Refractive index of a dielectric such as skin; null (default) where the material's metal reflects. */
  ior?: number | null
  /**
   * How many patches light sees: one number, or one along x and one along y; null (default) where the patch repeats for
   * ever. Not for the method 'line-sum'; 'baked' shows those that were baked in.
   */
  tiles?: number | Tiles | null
}

// A finite window's lobes are no Gaussians, on which 'line-sum' rests.
const WITH_TILES = ['jacobi-anger', 'taylor', 'baked'] as const
const ALL = ['line-sum', 'baked', 'jacobi-anger', 'taylor'] as const

/** A measured or generated relief that repeats over the whole surface. */
export class HeightField implements Surface {
  readonly name = 'HeightField'
  readonly glsl = heightFieldGlsl
  readonly glslFiles = heightFieldShaders
  readonly defines = {}
  readonly planarGratings = null
  readonly methods: readonly Method[]
  readonly energies = ['kirchhoff', 'relative'] as const
  readonly uniforms = {
    uReliefDirection: { value: new Vector2(1, 0) },
    uReliefStrength: { value: 1 },
    uReliefIor: { value: 1.5 },
  } satisfies Record<string, IUniform>
  /** The baked field's name or address. */
  readonly field: string
  /** How many patches light sees along x and y; null where there is no end to them. */
  readonly tiles: Tiles | null
  #orientation = 0
  #isDielectric = false
  #version = 0
  /** What the field's maps were baked from, all at once; known when the first of them is there. */
  #recipe: Record<string, unknown> = {}

  /** @param options - throws a DiffractionError where one is out of range */
  constructor({
    field,
    orientation = 0,
    strength = 1,
    ior = null,
    tiles = null,
  }: HeightFieldOptions) {
    if (typeof field !== 'string' || field === '')
      refuse(
        this.name,
        'field',
        field,
        'the name or address of a baked height field, without its method',
      )
    this.field = field
    this.tiles = tiles === null ? null : pairOfCounts(tiles)
    this.methods = this.tiles === null ? ALL : WITH_TILES
    this.orientation = orientation
    this.strength = strength
    this.ior = ior
  }

  get version(): number {
    return this.#version
  }

  /** Angle from growing u to the patch's x axis, rad. */
  get orientation(): number {
    return this.#orientation
  }

  set orientation(value: number) {
    this.#orientation = within(this.name, 'orientation', value, -Infinity, Infinity, 'rad')
    this.uniforms.uReliefDirection.value.set(Math.cos(value), Math.sin(value))
  }

  /** Share of the surface that diffracts, 0 to 1. */
  get strength(): number {
    return this.uniforms.uReliefStrength.value
  }

  set strength(value: number) {
    const wasPartial = this.isPartial
    this.uniforms.uReliefStrength.value = within(this.name, 'strength', value, 0, 1)
    if (this.isPartial !== wasPartial) this.#version++
  }

  get isPartial(): boolean {
    return this.strength < 1
  }

  measuredAs({ roughness }: OpticsSettings): string {
    if (this.tiles !== null) return 'repeated height field'
    return roughness > 0 ? 'rough height field' : 'sharp height field'
  }

  /** Refractive index of a dielectric; null where the material's metal reflects. */
  get ior(): number | null {
    return this.#isDielectric ? this.uniforms.uReliefIor.value : null
  }

  set ior(value: number | null) {
    // Below 1 light could be totally reflected; above 4 there is no transparent matter.
    if (value !== null) this.uniforms.uReliefIor.value = within(this.name, 'ior', value, 1, 4)
    this.#isDielectric = value !== null
    this.#version++
  }

  tables(settings: OpticsSettings, mapsPath: string): Record<string, string> {
    const { field } = this
    const address = field.includes('/') ? field : `${mapsPath}height-field-${field}`
    // The lines' amplitudes come from the same series.
    const baked = settings.method === 'line-sum' ? 'jacobi-anger' : settings.method
    return { relief: `${address}-${baked}`, ...spectrumUrls(settings, mapsPath) }
  }

  methodsKnown(settings: OpticsSettings): readonly Method[] {
    const { methods: baked = [] } = this.#recipe
    return this.methods.filter(
      (method) =>
        (baked as unknown[]).includes(method) &&
        (method !== 'baked' ||
          unlikeBaked(this.#recipe, settings, this.#isDielectric, this.tiles) === null),
    )
  }

  optics(tables: Record<string, LoadedMap>, settings: OpticsSettings): Optics {
    const maps = expectKinds(this.name, tables, {
      relief: settings.method === 'baked' ? 'height-field-baked' : 'height-field-terms',
      lobes: 'lobes',
      metals: 'metals',
    })
    this.#learn(maps.relief)
    return heightFieldOptics(maps, settings, this.#isDielectric, this.tiles)
  }

  /** A recipe says which methods have maps: materials that choose one look again. */
  #learn({ sidecar }: LoadedMap): void {
    const { recipe } = sidecar
    if (this.#recipe === recipe) return
    const isFirst = !Array.isArray(this.#recipe.methods)
    this.#recipe = recipe
    if (isFirst && Array.isArray(recipe.methods)) this.#version++
  }
}

function pairOfCounts(value: unknown): Tiles {
  const pair: unknown[] = Array.isArray(value) ? value : [value, value]
  if (pair.length === 2 && pair.every(isCount)) return [pair[0] as number, pair[1] as number]
  refuse(
    'HeightField',
    'tiles',
    value,
    'a whole number of patches above 0, two for x and y, or null for no end',
  )
}

function isCount(value: unknown): boolean {
  return Number.isInteger(value) && (value as number) > 0
}
