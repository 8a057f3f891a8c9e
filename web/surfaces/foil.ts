import { Vector2, Vector4, type IUniform, type Vector3 } from 'three'
import foilClustersGlsl from '../../shaders/surfaces/foil-clusters.glsl?raw'
import foilSharesGlsl from '../../shaders/surfaces/foil-shares.glsl?raw'
import foilGlsl from '../../shaders/surfaces/foil.glsl?raw'
import { refuse } from '../errors.ts'
import { gratingShaders } from '../glsl/grating-shaders.ts'
import { loadSharedMap } from '../maps/cache.ts'
import { arrayOf, constantOf, expectKind, type LoadedMap } from '../maps/load.ts'
import { imageTexture, smoothImageTexture } from '../maps/image-texture.ts'
import { floatLiteral } from '../glsl/float-literal.ts'
import { atOnce, bitByBit } from '../steps.ts'
import { foilContents, isOnePeriod, type FoilMean } from './foil-contents.ts'
import { MOST_GRATINGS } from './foil-shares.ts'
import { GratingSurface } from './grating-surface.ts'
import type { Optics, OpticsSettings } from './surface.ts'

/** What is other than the map says. */
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
  /** The GLSL of its point: a texel's grating, or the mean of many. */
  readonly glsl = foilGlsl
  /** The files that this GLSL includes, by the name it uses. */
  override readonly glslFiles = {
    ...gratingShaders,
    'foil-clusters.glsl': foilClustersGlsl,
    'foil-shares.glsl': foilSharesGlsl,
  }
  /** Defines that belong to the surface itself. */
  readonly defines: Record<string, string>
  /** Whether the strength is below one anywhere, so that the matt base shows through. */
  readonly isPartial: boolean
  /** Uniforms that belong to the surface itself; shared by all materials that show it. */
  readonly uniforms
  /** Size of one tile, mm. */
  readonly tile: readonly [number, number]
  /** Whether pixels that cover many texels show their mean. */
  readonly filtered: boolean
  /** Whether the map has bumps: normals of its own, which bend those of the mesh. */
  readonly hasBumps: boolean
  /** What the foil is made from. */
  readonly map: LoadedMap
  protected readonly periodRange: readonly [number, number]
  protected readonly mapRead
  protected override readonly frequencyReach
  readonly #mean: FoilMean | null

  /**
   * Loads a foil's map.
   *
   * @param url - its address without extension, as in `maps/baked/foil-polygons`
   * @param options - what is other than the map says
   */
  static async load(url: string, options: FoilOptions = {}): Promise<Foil> {
    return Foil.of(await loadSharedMap(url), options)
  }

  /**
   * Of a map that is loaded. Some of a foil takes long to look at: here it is done before, in between frames.
   *
   * @param options - what is other than the map says
   */
  static async of(map: LoadedMap, options: FoilOptions = {}): Promise<Foil> {
    expectKind(map, 'foil')
    await bitByBit(foilContents(map, periodsOf(map), options.filtered ?? true))
    return new Foil(map, options)
  }

  /** @param options - what is other than the map says; throws a DiffractionError where one is out of range */
  constructor(map: LoadedMap, options: FoilOptions = {}) {
    expectKind(map, 'foil')
    super(
      'Foil',
      options.height ?? constantOf(map, 'height_um')[0]!,
      options.profile ?? profileOfRecipe(map),
    )
    this.map = map
    const { spec } = arrayOf(map, 'grating')
    const decode = spec.decode ?? spec.channels.map((): [number, number] => [0, 1])
    const [tileWidth, tileHeight] = constantOf(map, 'tile_mm')
    this.tile = [tileWidth!, tileHeight!]
    this.periodRange = periodsOf(map)
    this.hasBumps = 'normal' in map.arrays
    this.defines = this.hasBumps ? { FOIL_BUMPS: '' } : {}
    this.uniforms = {
      uFoilMap: { value: imageTexture(map, 'grating') },
      uFoilOffset: { value: new Vector4().fromArray(decode.map(([offset]) => offset)) },
      uFoilScale: { value: new Vector4().fromArray(decode.map(([, scale]) => scale)) },
      uFoilRepeat: { value: options.repeat?.clone() ?? new Vector2(1, 1) },
      ...(this.hasBumps && bumpUniforms(map)),
    }
    this.repeat = this.uniforms.uFoilRepeat.value
    this.filtered = options.filtered ?? true
    const contents = atOnce(foilContents(map, this.periodRange, this.filtered))
    this.isPartial = !contents.isWhole
    const { mean } = contents
    this.#mean = mean
    const [low, high] = [1 / this.periodRange[1], 1 / this.periodRange[0]]
    this.frequencyReach = mean?.kind === 'clusters' ? (high - low) / 2 : 0
    this.mapRead =
      mean?.kind === 'shares'
        ? {
            included: false,
            why: `${mean.gratings.length} gratings are uniforms; the map has but their shares`,
          }
        : { included: true, why: 'its texels are read where a pixel covers few of them' }
  }

  /**
   * Defines and uniforms for those tables; throws a DiffractionError if they do not cover the surface.
   *
   * @param tables - the maps at the addresses that `tables` gives, by the same names
   */
  override optics(tables: Record<string, LoadedMap>, settings: OpticsSettings): Optics {
    const optics = super.optics(tables, settings)
    const mean = this.#mean
    const features = [
      ...optics.features,
      {
        feature: 'mean over the texels of a pixel',
        included: mean !== null,
        why: this.#whyMean(),
      },
      {
        feature: 'bumps',
        included: this.hasBumps,
        why: this.hasBumps ? 'the map has normals' : 'the map has no normals',
      },
    ]
    if (mean === null) return { ...optics, features }
    if (mean.kind === 'shares')
      return {
        ...optics,
        features,
        defines: { ...optics.defines, FOIL_GRATINGS: mean.gratings.length },
        uniforms: {
          ...optics.uniforms,
          uFoilShares: { value: mean.texture },
          uFoilGratings: { value: mean.gratings },
        },
      }
    const { underLights, underEnvironment } = mean
    const [low, high] = [1 / this.periodRange[1], 1 / this.periodRange[0]]
    const onePeriod = isOnePeriod(this.periodRange)
    return {
      ...optics,
      features,
      defines: {
        ...optics.defines,
        GRATING_SPREAD: '',
        ...(!this.isPartial && { FOIL_WHOLE: '' }),
        FOIL_CLUSTERS: underLights.count,
        FOIL_ARC_CLUSTERS: underEnvironment.count,
        FOIL_FREQUENCY: floatLiteral((low + high) / 2),
        FOIL_FREQUENCY_RANGE: floatLiteral(Math.max(high - low, 1e-6)),
        FOIL_TURN_BINS: onePeriod ? 6 : 4,
        FOIL_CHANGE_BINS: onePeriod ? 1 : 3,
      },
      uniforms: {
        ...optics.uniforms,
        uFoilClusters: { value: underLights.texture },
        uFoilReach: { value: underLights.reach },
        uFoilArcClusters: { value: underEnvironment.texture },
        uFoilArcReach: { value: underEnvironment.reach },
      },
    }
  }

  #whyMean(): string {
    if (!this.filtered) return 'filtered is false: the nearest texel is shown'
    if (this.#mean === null) return 'nothing on the foil diffracts'
    return this.#mean.kind === 'shares'
      ? `the foil has ${this.#mean.gratings.length} gratings, whose shares mip levels hold`
      : `the foil has more than ${MOST_GRATINGS} gratings, in clusters whose shares mip levels hold`
  }

  /** The class of surfaces as which the report measures it. */
  measuredAs(): string {
    return 'foil'
  }

  /** Tiles along u and v. */
  get repeat(): Vector2 {
    return this.uniforms.uFoilRepeat.value
  }

  set repeat(value: Vector2) {
    if (![value.x, value.y].every((tiles) => Number.isFinite(tiles) && tiles !== 0))
      refuse(this.name, 'repeat', value.toArray(), 'two finite numbers other than 0')
    this.uniforms.uFoilRepeat.value.copy(value)
  }

  /** Its gratings, (cos θ, sin θ, frequency in 1/µm), where they are few and lie flat; else null. */
  get planarGratings(): readonly Vector3[] | null {
    return this.#mean?.kind === 'shares' && !this.hasBumps ? this.#mean.gratings : null
  }

  /** Shortest and longest period on the foil, µm. */
  get period(): readonly [number, number] {
    return this.periodRange
  }
}

function bumpUniforms(map: LoadedMap): Record<string, IUniform> {
  const [u, v] = arrayOf(map, 'normal').spec.decode!
  return {
    uFoilNormal: { value: smoothImageTexture(map, 'normal') },
    uFoilNormalOffset: { value: new Vector2(u![0], v![0]) },
    uFoilNormalScale: { value: new Vector2(u![1], v![1]) },
  }
}

function profileOfRecipe(map: LoadedMap): string {
  const { profile } = map.sidecar.recipe
  if (typeof profile === 'string' && profile !== '') return profile
  refuse(`${map.url}.json`, 'recipe.profile', profile, "the name of the gratings' profile")
}

function periodsOf(map: LoadedMap): [number, number] {
  const lowest = constantOf(map, 'min_frequency')[0]!
  const highest = constantOf(map, 'max_frequency')[0]!
  if (!(lowest > 0 && highest >= lowest))
    refuse(
      `${map.url}.json`,
      'constants.min_frequency',
      lowest,
      `above 0 and not above max_frequency, ${highest} (1/µm)`,
    )
  return [1 / highest, 1 / lowest]
}
