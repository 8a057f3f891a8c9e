import { Vector2, Vector4, type Vector3 } from 'three'
import foilGlsl from '../../shaders/surfaces/foil.glsl?raw'
import { DiffractionError } from '../errors'
import { loadSharedMap } from '../maps/cache'
import { arrayOf, constantOf, expectKind, type LoadedMap } from '../maps/load'
import { imageTexture } from '../maps/image-texture'
import { foilShares, MOST_GRATINGS, type FoilShares } from './foil-shares'
import { GratingSurface } from './grating-surface'
import type { Optics, OpticsSettings } from './surface'

export interface FoilOptions {
  /** Tiles along u and v; (1, 1) by default. */
  repeat?: Vector2
  /** Height of the relief, µm; the sidecar's by default. */
  height?: number
  /** The gratings' profile; the recipe's by default. */
  profile?: string
  /** Whether pixels that cover many texels show their mean, true by default; false shows one texel of them. */
  filtered?: boolean
}

/** A map of gratings: a holographic foil, synthetic or measured. */
export class Foil extends GratingSurface {
  readonly glsl = foilGlsl
  readonly defines = {}
  readonly isPartial = true
  readonly uniforms
  /** Size of one tile, mm. */
  readonly tile: readonly [number, number]
  /** Whether pixels that cover many texels show their mean. */
  readonly filtered: boolean
  protected readonly periodRange: readonly [number, number]
  protected readonly mapRead
  readonly #shares: FoilShares | null

  /** Loads the map at an address without extension, as in `maps/baked/foil-dots`. */
  static async load(url: string, options: FoilOptions = {}): Promise<Foil> {
    return new Foil(await loadSharedMap(url), options)
  }

  constructor(map: LoadedMap, options: FoilOptions = {}) {
    expectKind(map, 'foil')
    super(
      'Foil',
      options.height ?? constantOf(map, 'height_um')[0]!,
      options.profile ?? profileOfRecipe(map),
    )
    const { spec } = arrayOf(map, 'grating')
    const decode = spec.decode ?? spec.channels.map((): [number, number] => [0, 1])
    const [tileWidth, tileHeight] = constantOf(map, 'tile_mm')
    this.tile = [tileWidth!, tileHeight!]
    this.periodRange = periodsOf(map)
    this.uniforms = {
      uFoilMap: { value: imageTexture(map, 'grating') },
      uFoilOffset: { value: new Vector4().fromArray(decode.map(([offset]) => offset)) },
      uFoilScale: { value: new Vector4().fromArray(decode.map(([, scale]) => scale)) },
      uFoilRepeat: { value: options.repeat?.clone() ?? new Vector2(1, 1) },
    }
    this.repeat = this.uniforms.uFoilRepeat.value
    this.filtered = options.filtered ?? true
    this.#shares = this.filtered ? foilShares(map) : null
    const count = this.#shares?.gratings.length ?? 0
    this.mapRead =
      this.#shares === null
        ? { included: true, why: 'a texel of it is read at each pixel' }
        : { included: false, why: `${count} gratings are uniforms; the map has but their shares` }
  }

  override optics(tables: Record<string, LoadedMap>, settings: OpticsSettings): Optics {
    const optics = super.optics(tables, settings)
    const shares = this.#shares
    const feature = {
      feature: 'mean over the texels of a pixel',
      included: shares !== null,
      why:
        shares !== null
          ? `the foil has ${shares.gratings.length} gratings, whose shares mip levels hold`
          : this.filtered
            ? `the foil has none, or more than ${MOST_GRATINGS} gratings: the nearest texel is shown`
            : 'filtered is false: the nearest texel is shown',
    }
    const features = [...optics.features, feature]
    if (shares === null) return { ...optics, features }
    const { gratings, texture } = shares
    return {
      ...optics,
      features,
      defines: { ...optics.defines, FOIL_GRATINGS: gratings.length },
      uniforms: {
        ...optics.uniforms,
        uFoilShares: { value: texture },
        uFoilGratings: { value: gratings },
      },
    }
  }

  measuredAs(): string {
    return 'foil'
  }

  /** Tiles along u and v. */
  get repeat(): Vector2 {
    return this.uniforms.uFoilRepeat.value
  }

  set repeat(value: Vector2) {
    if (![value.x, value.y].every((tiles) => Number.isFinite(tiles) && tiles !== 0))
      throw new DiffractionError({
        file: this.name,
        field: 'repeat',
        value: value.toArray(),
        expected: 'two finite numbers other than 0',
      })
    this.uniforms.uFoilRepeat.value.copy(value)
  }

  get planarGratings(): readonly Vector3[] | null {
    return this.#shares?.gratings ?? null
  }

  /** Shortest and longest period on the foil, µm. */
  get period(): readonly [number, number] {
    return this.periodRange
  }
}

function profileOfRecipe(map: LoadedMap): string {
  const { profile } = map.sidecar.recipe
  if (typeof profile === 'string' && profile !== '') return profile
  throw new DiffractionError({
    file: `${map.url}.json`,
    field: 'recipe.profile',
    value: profile,
    expected: "the name of the gratings' profile",
  })
}

function periodsOf(map: LoadedMap): [number, number] {
  const lowest = constantOf(map, 'min_frequency')[0]!
  const highest = constantOf(map, 'max_frequency')[0]!
  if (!(lowest > 0 && highest >= lowest))
    throw new DiffractionError({
      file: `${map.url}.json`,
      field: 'constants.min_frequency',
      value: lowest,
      expected: `above 0 and not above max_frequency, ${highest} (1/µm)`,
    })
  return [1 / highest, 1 / lowest]
}
