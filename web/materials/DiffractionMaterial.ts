import {
  BackSide,
  Color,
  Euler,
  Material,
  Matrix3,
  ShaderMaterial,
  TangentSpaceNormalMap,
  UniformsLib,
  UniformsUtils,
  Vector2,
  type BufferGeometry,
  type Camera,
  type Group,
  type MaterialParameters,
  type Object3D,
  type Scene,
  type Texture,
  type WebGLRenderer,
} from 'three'
import { checkEnvironment, environmentMap } from '../environment/environment-map.ts'
import type { DiffractionError } from '../errors.ts'
import { fragmentShader, vertexShader } from '../glsl/material-shaders.ts'
import type { LoadedMap } from '../maps/load.ts'
import type {
  Efficiencies,
  Energy,
  Feature,
  Metal,
  Method,
  Observer,
  OpticsSettings,
  Surface,
} from '../surfaces/surface.ts'
import { angularRadius, oneOf, within } from '../validation.ts'
import { ChosenOptics } from './chosen-optics.ts'
import { Defines } from './defines.ts'
import { choose } from './features.ts'
import { assertLightLoops } from './light-order.ts'
import { GAMUTS, type DiffractionMaterialOptions, type Gamut } from './options.ts'
import { SceneOptics } from './scene-optics.ts'

const OWNER = 'DiffractionMaterial'

/**
 * A material for WebGLRenderer whose surface diffracts: over a matt base, under a clear lacquer, lit by
 * directional, point and spot lights and by an environment. Ambient and hemisphere lights and light probes reach the
 * matt base alone; area lights (RectAreaLight) light nothing, they have no one direction to diffract from.
 */
export class DiffractionMaterial extends ShaderMaterial {
  override readonly type = 'DiffractionMaterial'
  /** Tells three to pass on a geometry's tangents and uv: a grating has a direction. */
  readonly anisotropy = 1
  /** Normal maps lie in the tangent frame, as three's default has it. */
  readonly normalMapType = TangentSpaceNormalMap

  /** Albedo of the matt base. */
  readonly color = new Color(0xffffff)
  /** How far the normal map bends normals, along u and along v: a factor each, 1 by default. */
  readonly normalScale = new Vector2(1, 1)
  /** How far the bump map bends normals: a factor as in three, 1 by default. */
  bumpScale = 1
  /** Factor of the radiance of `envMap`, 1 by default; the scene's own has `environmentIntensity`. */
  envMapIntensity = 1
  /** Normals from the triangles; as in three's materials, a change needs `needsUpdate`. */
  flatShading = false
  /** How `envMap` is turned, rad. */
  readonly envMapRotation = new Euler()
  /** Whether a flat mesh under an environment may read a table in place of the nodes. */
  planarEnvironment = true
  /** Told of tables that could not be loaded; prints to the console by default. */
  onError: (error: DiffractionError) => void = (error) => {
    console.error(error)
  }

  readonly #chosen: ChosenOptics
  readonly #scene: SceneOptics
  #lightAngularRadius: number | null = null
  #gamut: Gamut = 'map'
  #map: Texture | null = null
  #normalMap: Texture | null = null
  #bumpMap: Texture | null = null
  #envMap: Texture | null = null

  /**
   * @param options - a surface, and what differs from the defaults. Throws a DiffractionError where one is out of
   * range.
   */
  constructor(options: DiffractionMaterialOptions) {
    super()
    assertLightLoops()
    const { surface, mapsPath = 'maps/baked/', maps = {}, ...values } = options
    const defines = new Defines((values) => {
      this.defines = values
      this.needsUpdate = true
    })
    this.#scene = new SceneOptics(OWNER, defines, this.uniforms)
    this.#chosen = new ChosenOptics(
      {
        name: OWNER,
        useSurface: (used, isNew) => {
          this.#useSurface(used, isNew)
        },
        useOptics: (optics) => {
          this.#scene.useOptics(optics)
        },
        onError: (error) => {
          this.onError(error)
        },
      },
      surface,
      mapsPath,
      maps,
    )
    this.lights = true
    this.fog = true
    this.clipping = true
    this.vertexShader = vertexShader
    Object.assign(
      this.uniforms,
      UniformsUtils.merge([UniformsLib.lights, UniformsLib.fog]),
      this.#ownUniforms(),
    )
    this.#useSurface(surface, true)
    this.#scene.defines.set('GAMUT_MAPPED', this.#gamut === 'map')
    this.setValues(values)
    this.#chosen.begin()
  }

  /** Resolves when all tables are there and in use; rejects with a DiffractionError. */
  get ready(): Promise<void> {
    return this.#chosen.ready
  }

  /** What diffracts. A new one keeps the settings that it can be drawn with. */
  get surface(): Surface {
    return this.#chosen.surface
  }

  set surface(value: Surface) {
    this.#chosen.surface = value
  }

  /** Folder of the baked tables, with its slash. */
  get mapsPath(): string {
    return this.#chosen.mapsPath
  }

  /** Maps that are taken in the place of what their addresses would fetch. */
  get maps(): Readonly<Record<string, LoadedMap>> {
    return this.#chosen.maps
  }

  /** What reflects. */
  get metal(): Metal {
    return this.#chosen.settings.metal
  }

  set metal(value: Metal) {
    this.#chosen.set('metal', value)
  }

  /** Spectrum of lights and environment: a baked one's name or a map's address. */
  get illuminant(): string {
    return this.#chosen.settings.illuminant
  }

  set illuminant(value: string) {
    this.#chosen.set('illuminant', value)
  }

  /** Whose colour-matching functions make colours of spectra. */
  get observer(): Observer {
    return this.#chosen.settings.observer
  }

  set observer(value: Observer) {
    this.#chosen.set('observer', value)
  }

  /** How efficiencies are normalised over the orders that propagate. */
  get energy(): Energy {
    return this.#chosen.settings.energy
  }

  set energy(value: Energy) {
    this.#chosen.set('energy', value)
  }

  /** By which method light is summed over wavelengths and orders. */
  get method(): Method {
    return this.#chosen.settings.method
  }

  set method(value: Method) {
    this.#chosen.set('method', value)
  }

  /** Step of the wavelength loop, µm. */
  get wavelengthStep(): number {
    return this.#chosen.settings.wavelengthStep
  }

  set wavelengthStep(value: number) {
    this.#chosen.set('wavelengthStep', value)
  }

  /** Where the wavelength loop has efficiencies from: the profile's table, or the papers' Taylor series. */
  get efficiencies(): Efficiencies {
    return this.#chosen.settings.efficiencies
  }

  set efficiencies(value: Efficiencies) {
    this.#chosen.set('efficiencies', value)
  }

  /** Standard deviation σ of the coherence window, µm. */
  get coherence(): number {
    return this.#chosen.settings.coherence
  }

  set coherence(value: number) {
    this.#chosen.set('coherence', value)
  }

  /** Standard deviation of the surface's tilt, rad. */
  get roughness(): number {
    return this.#chosen.settings.roughness
  }

  set roughness(value: number) {
    this.#chosen.set('roughness', value)
  }

  /** Number of nodes at which an order's arc of the environment is read, 1 to 401. */
  get environmentNodes(): number {
    return this.#chosen.settings.environmentNodes
  }

  set environmentNodes(value: number) {
    this.#chosen.set('environmentNodes', value)
  }

  /** Names of the settings that were given; where `maxError` is, it chooses the others. */
  get given(): ReadonlySet<keyof OpticsSettings> {
    return this.#chosen.given
  }

  /**
   * Largest relative root mean square error of radiance for which method and knobs are chosen, but for those that were
   * given; null: nothing is chosen. `explain()` says what was, and whether it is enough.
   */
  get maxError(): number | null {
    return this.#chosen.maxError
  }

  set maxError(value: number | null) {
    this.#chosen.maxError = value
  }

  /** Whether the surface diffracts; false compiles diffraction out and leaves base and lacquer. */
  get diffraction(): boolean {
    return this.#scene.isOn
  }

  set diffraction(value: boolean) {
    this.#scene.isOn = value
  }

  /** Radius (standard deviation, rad) of lights that state none in `userData.angularRadius`; null: points. */
  get lightAngularRadius(): number | null {
    return this.#lightAngularRadius
  }

  set lightAngularRadius(value: number | null) {
    this.#lightAngularRadius =
      value === null ? null : angularRadius(OWNER, 'lightAngularRadius', value)
  }

  /** Share of the surface under a clear lacquer, 0 to 1. */
  get coat(): number {
    return this.#number('uCoat')
  }

  set coat(value: number) {
    this.#setNumber('uCoat', within(OWNER, 'coat', value, 0, 1))
    this.#scene.defines.set('COAT', value > 0)
  }

  /** The lacquer's refractive index, 1 to 4. */
  get coatIor(): number {
    return this.#number('uCoatIor')
  }

  set coatIor(value: number) {
    // Below 1 light could be totally reflected; above 4 lies no lacquer.
    this.#setNumber('uCoatIor', within(OWNER, 'coatIor', value, 1, 4))
  }

  /** The lacquer's roughness as three counts it, 0 to 1. */
  get coatRoughness(): number {
    return this.#number('uCoatRoughness')
  }

  set coatRoughness(value: number) {
    this.#setNumber('uCoatRoughness', within(OWNER, 'coatRoughness', value, 0, 1))
  }

  /** Whether colours are moved into the display's gamut ('map') or left as sums ('signed'). */
  get gamut(): Gamut {
    return this.#gamut
  }

  set gamut(value: Gamut) {
    this.#gamut = oneOf(OWNER, 'gamut', value, GAMUTS)
    this.#scene.defines.set('GAMUT_MAPPED', value === 'map')
  }

  /** Colours of the matt base, times `color`. */
  get map(): Texture | null {
    return this.#map
  }

  set map(value: Texture | null) {
    this.#map = this.#setTexture('map', this.#map, value)
  }

  /** Normals in the tangent frame, scaled by `normalScale`. */
  get normalMap(): Texture | null {
    return this.#normalMap
  }

  set normalMap(value: Texture | null) {
    this.#normalMap = this.#setTexture('normalMap', this.#normalMap, value)
  }

  /** Heights that bend normals, scaled by `bumpScale`. */
  get bumpMap(): Texture | null {
    return this.#bumpMap
  }

  set bumpMap(value: Texture | null) {
    this.#bumpMap = this.#setTexture('bumpMap', this.#bumpMap, value)
  }

  /**
   * The environment, in place of the scene's. Reads back as the texture that is sampled, which for one without mip
   * levels is a copy that shares its image.
   */
  get envMap(): Texture | null {
    if (this.#envMap === null) return null
    return environmentMap(this.#envMap, OWNER)?.texture ?? this.#envMap
  }

  set envMap(value: Texture | null) {
    if (value !== null) checkEnvironment(value, OWNER)
    this.#envMap = value
  }

  /** What is compiled in, what is left out, and why. */
  explain(): Feature[] {
    const { surface, state, error, settings, features } = this.#chosen
    const textures = { map: this.#map, normalMap: this.#normalMap, bumpMap: this.#bumpMap }
    return [
      ...this.#scene.explain(state, error, settings),
      ...features,
      choose(
        'matt base',
        surface.isPartial,
        `the strength of ${surface.name} is below 1 somewhere`,
        `the strength of ${surface.name} is 1 everywhere`,
      ),
      choose('lacquer', 'COAT' in this.defines, 'coat is above 0', 'coat is 0'),
      choose('gamut mapping', this.#gamut === 'map', "gamut is 'map'", "gamut is 'signed'"),
      ...Object.entries(textures).map(([name, texture]) =>
        choose(name, texture !== null, 'a texture is set', 'no texture is set'),
      ),
    ]
  }

  override onBeforeRender(
    renderer: WebGLRenderer,
    scene: Scene,
    camera: Camera,
    geometry: BufferGeometry,
    object: Object3D,
    group: Group,
  ): void {
    super.onBeforeRender(renderer, scene, camera, geometry, object, group)
    this.#chosen.follow()
    this.#followTextures()
    this.#scene.follow({
      renderer,
      scene,
      camera,
      geometry,
      object,
      side: this.side,
      settings: this.#chosen.settings,
      environment:
        this.#envMap === null
          ? null
          : { map: this.#envMap, intensity: this.envMapIntensity, rotation: this.envMapRotation },
      obstacle: this.#planarObstacle(),
      lightRadius: this.#lightAngularRadius ?? 0,
    })
    this.#setNumber('uOpacity', this.opacity)
  }

  override dispose(): void {
    super.dispose()
    this.#scene.dispose()
  }

  /**
   * Shares surface, maps and tables with the source, and copies the rest.
   *
   * @param source - another of its kind
   */
  override copy(source: this): this {
    // Not ShaderMaterial's, which would clone every table's texture.
    Material.prototype.copy.call(this, source)
    this.#chosen.maps = source.maps
    this.surface = source.surface
    this.setValues(source.#options())
    this.#chosen.copyGiven(source.#chosen)
    return this
  }

  override clone(): this {
    const { surface, mapsPath, maps } = this
    return new DiffractionMaterial({ surface, mapsPath, maps }).copy(this) as this
  }

  #options(): MaterialParameters & Omit<DiffractionMaterialOptions, 'surface' | 'mapsPath'> {
    return {
      ...this.#chosen.settings,
      diffraction: this.diffraction,
      lightAngularRadius: this.#lightAngularRadius,
      coat: this.coat,
      coatIor: this.coatIor,
      coatRoughness: this.coatRoughness,
      color: this.color,
      map: this.#map,
      normalMap: this.#normalMap,
      normalScale: this.normalScale,
      bumpMap: this.#bumpMap,
      bumpScale: this.bumpScale,
      flatShading: this.flatShading,
      envMap: this.#envMap,
      envMapIntensity: this.envMapIntensity,
      envMapRotation: this.envMapRotation,
      planarEnvironment: this.planarEnvironment,
      gamut: this.#gamut,
      onError: this.onError,
    }
  }

  #ownUniforms(): Record<string, { value: unknown }> {
    return {
      uBaseColor: { value: this.color },
      uOpacity: { value: 1 },
      uCoat: { value: 0 },
      uCoatIor: { value: 1.5 },
      uCoatRoughness: { value: 0 },
      map: { value: null },
      mapTransform: { value: new Matrix3() },
      normalMap: { value: null },
      normalMapTransform: { value: new Matrix3() },
      normalScale: { value: new Vector2(1, 1) },
      bumpMap: { value: null },
      bumpMapTransform: { value: new Matrix3() },
      bumpScale: { value: 1 },
    }
  }

  #useSurface(surface: Surface, isNew: boolean): void {
    this.#scene.useSurface(surface, isNew)
    this.#scene.defines.set('BASE', surface.isPartial)
    if (!isNew) return
    this.fragmentShader = fragmentShader(surface)
    this.needsUpdate = true
  }

  #planarObstacle(): string | null {
    if (!this.planarEnvironment) return 'planarEnvironment is false'
    if (this.#normalMap !== null || this.#bumpMap !== null) return 'a map bends the normals'
    return this.flatShading ? 'flatShading takes normals from the triangles' : null
  }

  #followTextures(): void {
    // A back side's outward normal is the other one; three turns its maps round in the same way.
    const sign = this.side === BackSide ? -1 : 1
    if (this.#map !== null) this.#followTransform('mapTransform', this.#map)
    if (this.#normalMap !== null) {
      this.#followTransform('normalMapTransform', this.#normalMap)
      const scale = this.uniforms.normalScale!.value as Vector2
      scale.copy(this.normalScale).multiplyScalar(sign)
    }
    if (this.#bumpMap !== null) {
      this.#followTransform('bumpMapTransform', this.#bumpMap)
      this.#setNumber('bumpScale', sign * this.bumpScale)
    }
  }

  #followTransform(name: string, texture: Texture): void {
    if (texture.matrixAutoUpdate) texture.updateMatrix()
    const transform = this.uniforms[name]!.value as Matrix3
    transform.copy(texture.matrix)
  }

  #setTexture(name: string, before: Texture | null, value: Texture | null): Texture | null {
    this.uniforms[name]!.value = value
    if ((before === null) !== (value === null) || before?.channel !== value?.channel)
      this.needsUpdate = true
    return value
  }

  #number(name: string): number {
    return this.uniforms[name]!.value as number
  }

  #setNumber(name: string, value: number): void {
    this.uniforms[name]!.value = value
  }
}
