import {
  BackSide,
  Color,
  Euler,
  Material,
  Matrix3,
  Matrix4,
  ShaderMaterial,
  TangentSpaceNormalMap,
  Texture,
  UniformsLib,
  UniformsUtils,
  Vector2,
  type BufferGeometry,
  type Camera,
  type Group,
  type IUniform,
  type MaterialParameters,
  type Object3D,
  type Scene,
  type WebGLRenderer,
} from 'three'
import { BLURRED_LAYERS, BlurredEnvironment } from '../environment/blurred-environment.ts'
import {
  checkEnvironment,
  environmentMap,
  type EnvironmentMap,
} from '../environment/environment-map.ts'
import { PlanarEnvironment } from '../environment/planar-environment.ts'
import { PLANAR_TEXELS } from '../environment/planar-table.ts'
import type { DiffractionError } from '../errors.ts'
import { floatLiteral } from '../glsl/float-literal.ts'
import { fragmentShader, vertexShader } from '../glsl/material-shaders.ts'
import type { LoadedMap } from '../maps/load.ts'
import { refinementFrame, type RefinementFrame } from '../refinement/refinement-frame.ts'
import type {
  Efficiencies,
  Energy,
  EnvironmentRefinement,
  Feature,
  LightOptics,
  Metal,
  Method,
  Observer,
  Optics,
  OpticsSettings,
  Surface,
} from '../surfaces/surface.ts'
import { angularRadius, oneOf, positive, within } from '../validation.ts'
import { CHOSEN_SETTINGS, choiceForError } from './error-choice.ts'
import { describeFeatures } from './features.ts'
import { assertLightLoops } from './light-order.ts'
import { OpticsLoader } from './optics-loader.ts'
import {
  DEFAULT_SETTINGS,
  GAMUTS,
  SETTING_CHECKS,
  type DiffractionMaterialOptions,
  type Gamut,
} from './options.ts'
import { sceneLights } from './scene-lights.ts'

const OWNER = 'DiffractionMaterial'

const rotationMatrix = new Matrix4()
/** Cube textures that were not rendered keep the left-handed axes of their images. */
const mirrorX = new Matrix3().set(-1, 0, 0, 0, 1, 0, 0, 0, 1)

/**
 * A material for WebGLRenderer whose surface diffracts: over a matt base, under a clear lacquer, lit by
 * directional, point and spot lights and by an environment. Ambient and hemisphere lights and light probes reach the
 * matt base alone; area lights (RectAreaLight) light nothing, they have no one direction to diffract from.
 */
export class DiffractionMaterial extends ShaderMaterial {
  override readonly type = 'DiffractionMaterial'
  /** Tells three to pass on a geometry's tangents and uv: a grating has a direction. */
  readonly anisotropy = 1
  readonly normalMapType = TangentSpaceNormalMap

  /** Albedo of the matt base. */
  readonly color = new Color(0xffffff)
  readonly normalScale = new Vector2(1, 1)
  bumpScale = 1
  envMapIntensity = 1
  /** Normals from the triangles; as in three's materials, a change needs `needsUpdate`. */
  flatShading = false
  readonly envMapRotation = new Euler()
  /** Whether a flat mesh under an environment may read a table in place of the nodes. */
  planarEnvironment = true
  onError: (error: DiffractionError) => void = (error) => {
    console.error(error)
  }

  readonly #settings: OpticsSettings = { ...DEFAULT_SETTINGS }
  /** Names of the settings that were given. */
  readonly #given = new Set<keyof OpticsSettings>()
  #maxError: number | null = null
  #errorFeatures: readonly Feature[] = []
  readonly #optics: OpticsLoader
  /** The settings of the optics in use; null before the first. */
  #applied: OpticsSettings | null = null
  #opticsDefines: string[] = []
  readonly #opticsUniforms = new Set<string>()
  #opticsFeatures: readonly Feature[] = []
  #environmentFeatures: readonly Feature[] = []
  /** Makes what an environment needs of the optics; null once it is there. */
  #environmentUniforms: Optics['environmentUniforms'] | null = null
  #environmentRefinement: EnvironmentRefinement | null = null
  /** Whether the last frame drawn was one of a refinement. */
  #isRefined = false
  /** How many frames of a refinement the uniforms serve; 0: of none. */
  #refinementFrames = 0
  #underLights: Optics['underLights'] = () => ({ defines: {}, features: [] })
  /** What the lights of the last frame drawn asked of the optics. */
  #lightOptics: LightOptics = { defines: {}, features: [] }
  #largestRadius = -1
  #environmentRepaired = 0
  readonly #planar = new PlanarEnvironment()
  readonly #blurred = new BlurredEnvironment()
  #blursEnvironment = false
  #opticsVersion = 0
  #surface: Surface
  #surfaceVersion = -1
  #mapsPath: string
  #diffraction = true
  #lightAngularRadius: number | null = null
  #gamut: Gamut = 'map'
  #map: Texture | null = null
  #normalMap: Texture | null = null
  #bumpMap: Texture | null = null
  #envMap: Texture | null = null
  /** False while the constructor sets one option after the other. */
  #isComplete = false

  constructor(options: DiffractionMaterialOptions) {
    super()
    assertLightLoops()
    const { surface, mapsPath = 'maps/baked/', maps = {}, ...values } = options
    this.#surface = surface
    this.#takeDefaults()
    this.#mapsPath = mapsPath
    this.#optics = new OpticsLoader(
      (optics) => {
        this.#apply(optics)
      },
      (error) => {
        this.#fail(error)
      },
      maps,
    )
    this.lights = true
    this.fog = true
    this.clipping = true
    this.vertexShader = vertexShader
    this.uniforms = {
      ...UniformsUtils.merge([UniformsLib.lights, UniformsLib.fog]),
      ...this.#ownUniforms(),
    }
    this.#useSurface()
    this.setValues(values)
    this.#isComplete = true
    this.#request()
  }

  /** Resolves when all tables are there and in use; rejects with a DiffractionError. */
  get ready(): Promise<void> {
    this.#followSurface()
    return this.#optics.ready
  }

  get surface(): Surface {
    return this.#surface
  }

  set surface(value: Surface) {
    if (value === this.#surface) return
    this.#surface = value
    this.#takeDefaults()
    this.#useSurface()
    this.#request()
  }

  get mapsPath(): string {
    return this.#mapsPath
  }

  /** Maps that are taken in the place of what their addresses would fetch. */
  get maps(): Readonly<Record<string, LoadedMap>> {
    return this.#optics.maps
  }

  get metal(): Metal {
    return this.#settings.metal
  }

  set metal(value: Metal) {
    this.#set('metal', value)
  }

  get illuminant(): string {
    return this.#settings.illuminant
  }

  set illuminant(value: string) {
    this.#set('illuminant', value)
  }

  get observer(): Observer {
    return this.#settings.observer
  }

  set observer(value: Observer) {
    this.#set('observer', value)
  }

  /** How efficiencies are normalised over the orders that propagate. */
  get energy(): Energy {
    return this.#settings.energy
  }

  set energy(value: Energy) {
    this.#set('energy', value)
  }

  get method(): Method {
    return this.#settings.method
  }

  set method(value: Method) {
    this.#set('method', value)
  }

  /** Step of the wavelength loop, µm. */
  get wavelengthStep(): number {
    return this.#settings.wavelengthStep
  }

  set wavelengthStep(value: number) {
    this.#set('wavelengthStep', value)
  }

  get efficiencies(): Efficiencies {
    return this.#settings.efficiencies
  }

  set efficiencies(value: Efficiencies) {
    this.#set('efficiencies', value)
  }

  /** Standard deviation σ of the coherence window, µm. */
  get coherence(): number {
    return this.#settings.coherence
  }

  set coherence(value: number) {
    this.#set('coherence', value)
  }

  /** Standard deviation of the surface's tilt, rad. */
  get roughness(): number {
    return this.#settings.roughness
  }

  set roughness(value: number) {
    this.#set('roughness', value)
  }

  get environmentNodes(): number {
    return this.#settings.environmentNodes
  }

  set environmentNodes(value: number) {
    this.#set('environmentNodes', value)
  }

  /** Names of the settings that were given; where `maxError` is, it chooses the others. */
  get given(): ReadonlySet<keyof OpticsSettings> {
    return this.#given
  }

  /**
   * Largest relative root mean square error of radiance for which method and knobs are chosen, but for those that were
   * given; null: nothing is chosen. `explain()` says what was, and whether it is enough.
   */
  get maxError(): number | null {
    return this.#maxError
  }

  set maxError(value: number | null) {
    this.#maxError = value === null ? null : positive(OWNER, 'maxError', value, '')
    this.#request()
  }

  /** Whether the surface diffracts; false compiles diffraction out and leaves base and lacquer. */
  get diffraction(): boolean {
    return this.#diffraction
  }

  set diffraction(value: boolean) {
    this.#diffraction = value
    this.#setDefine('DIFFRACTION', this.#applied !== null && value)
  }

  /** Radius (standard deviation, rad) of lights that state none in `userData.angularRadius`; null: points. */
  get lightAngularRadius(): number | null {
    return this.#lightAngularRadius
  }

  set lightAngularRadius(value: number | null) {
    this.#lightAngularRadius =
      value === null ? null : angularRadius(OWNER, 'lightAngularRadius', value)
  }

  get coat(): number {
    return this.#number('uCoat')
  }

  set coat(value: number) {
    this.#setNumber('uCoat', within(OWNER, 'coat', value, 0, 1))
    this.#setDefine('COAT', value > 0)
  }

  get coatIor(): number {
    return this.#number('uCoatIor')
  }

  set coatIor(value: number) {
    // Below 1 light could be totally reflected; above 4 lies no lacquer.
    this.#setNumber('uCoatIor', within(OWNER, 'coatIor', value, 1, 4))
  }

  get coatRoughness(): number {
    return this.#number('uCoatRoughness')
  }

  set coatRoughness(value: number) {
    this.#setNumber('uCoatRoughness', within(OWNER, 'coatRoughness', value, 0, 1))
  }

  get gamut(): Gamut {
    return this.#gamut
  }

  set gamut(value: Gamut) {
    this.#gamut = oneOf(OWNER, 'gamut', value, GAMUTS)
    this.#setDefine('GAMUT_MAPPED', value === 'map')
  }

  get map(): Texture | null {
    return this.#map
  }

  set map(value: Texture | null) {
    this.#map = this.#setTexture('map', this.#map, value)
  }

  get normalMap(): Texture | null {
    return this.#normalMap
  }

  set normalMap(value: Texture | null) {
    this.#normalMap = this.#setTexture('normalMap', this.#normalMap, value)
  }

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
    return environmentMap(this.#envMap)?.texture ?? this.#envMap
  }

  set envMap(value: Texture | null) {
    if (value !== null) checkEnvironment(value)
    this.#envMap = value
  }

  /** What is compiled in, what is left out, and why. */
  explain(): Feature[] {
    return describeFeatures({
      defines: this.defines,
      opticsFeatures: [
        ...this.#errorFeatures,
        ...this.#opticsFeatures,
        ...this.#lightOptics.features,
      ],
      environmentFeatures: this.#environmentFeatures,
      environmentRepaired: this.#environmentRepaired,
      planarWhy: this.#planar.why,
      blurWhy: this.#blurWhy,
      diffraction: this.#diffraction,
      opticsState: this.#optics.state,
      opticsError: this.#optics.error,
      isPartial: this.#surface.isPartial,
      surfaceName: this.#surface.name,
      gamut: this.#gamut,
      textures: { map: this.#map, normalMap: this.#normalMap, bumpMap: this.#bumpMap },
      lights: (this.uniforms.uLightAngularRadii!.value as number[]).length,
    })
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
    this.#followSurface()
    this.#followLights(renderer, scene, camera)
    const environment = this.#followEnvironment(scene)
    this.#followTextures()
    this.#followPlane(renderer, camera, geometry, object)
    this.#followBlur(renderer, camera, environment)
    this.#setNumber('uOpacity', this.opacity)
  }

  override dispose(): void {
    super.dispose()
    this.#planar.dispose()
    this.#blurred.dispose()
    for (const name of this.#opticsUniforms) disposeTexture(this.uniforms[name]?.value)
    for (const { value } of Object.values(this.#surface.uniforms)) disposeTexture(value)
  }

  /** Shares surface, maps and tables with the source, and copies the rest. */
  override copy(source: this): this {
    // Not ShaderMaterial's, which would clone every table's texture.
    Material.prototype.copy.call(this, source)
    this.#optics.maps = source.maps
    this.surface = source.surface
    this.setValues(source.#options())
    this.#given.clear()
    for (const name of source.#given) this.#given.add(name)
    this.maxError = source.maxError
    return this
  }

  override clone(): this {
    const { surface, mapsPath, maps } = this
    return new DiffractionMaterial({ surface, mapsPath, maps }).copy(this) as this
  }

  #options(): MaterialParameters & Omit<DiffractionMaterialOptions, 'surface' | 'mapsPath'> {
    return {
      ...this.#settings,
      diffraction: this.#diffraction,
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

  #ownUniforms(): Record<string, IUniform> {
    return {
      uBaseColor: { value: this.color },
      uOpacity: { value: 1 },
      uCoat: { value: 0 },
      uCoatIor: { value: 1.5 },
      uCoatRoughness: { value: 0 },
      uLightAngularRadii: { value: [] as number[] },
      uEnvironmentMap: { value: null },
      uEnvironmentRotation: { value: new Matrix3() },
      uEnvironmentIntensity: { value: 1 },
      uEnvironmentTexel: { value: 1 },
      uPlanarEnvironment: { value: null },
      uBlurredLayers: { value: null },
      uBlurUnit: { value: 1 },
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

  /** One of the optics' settings: taken if the surface can be shown with it, else as it was. */
  #set<K extends keyof OpticsSettings>(name: K, value: OpticsSettings[K]): void {
    const checked = this.#checked(name, value)
    const wasGiven = this.#given.has(name)
    this.#given.add(name)
    if (checked === this.#settings[name]) return
    const before = { ...this.#settings }
    this.#settings[name] = checked
    try {
      this.#request()
    } catch (error) {
      Object.assign(this.#settings, before)
      if (!wasGiven) this.#given.delete(name)
      this.#choose()
      throw error
    }
  }

  /** Some settings are a question of what the surface offers. */
  #checked<K extends keyof OpticsSettings>(name: K, value: unknown): OpticsSettings[K] {
    const checked = SETTING_CHECKS[name](value)
    if (name === 'method') oneOf(OWNER, name, value, this.#surface.methods)
    if (name === 'energy') oneOf(OWNER, name, value, this.#surface.energies)
    return checked
  }

  /** A method or energy that the surface does not have gives way to its default. */
  #takeDefaults(): void {
    const { methods, energies } = this.#surface
    const settings = this.#settings
    if (!methods.includes(settings.method)) {
      settings.method = methods[0]!
      this.#given.delete('method')
    }
    if (!energies.includes(settings.energy)) settings.energy = energies[0]!
  }

  /** Chooses what was not given, if an error was; what it chose before goes with the error. */
  #choose(): void {
    const isChosen = this.#errorFeatures.length > 0
    this.#errorFeatures = []
    if (this.#maxError === null && !isChosen) return
    const defaults = { ...DEFAULT_SETTINGS, method: this.#surface.methods[0]! }
    const free = CHOSEN_SETTINGS.filter((name) => !this.#given.has(name))
    Object.assign(this.#settings, Object.fromEntries(free.map((name) => [name, defaults[name]])))
    if (this.#maxError === null) return
    const choice = choiceForError(this.#surface, this.#settings, this.#given, this.#maxError)
    Object.assign(this.#settings, choice.settings)
    this.#errorFeatures = choice.features
  }

  #request(): void {
    if (!this.#isComplete) return
    this.#surfaceVersion = this.#surface.version
    this.#choose()
    this.#optics.request(this.#surface, this.#settings, this.#mapsPath)
  }

  /** Takes over what a surface changed since the last look, in a frame or before `ready` is awaited. */
  #followSurface(): void {
    if (this.#surface.version === this.#surfaceVersion) return
    this.#setDefines(this.#surface.defines)
    this.#setDefine('BASE', this.#surface.isPartial)
    this.#request()
  }

  #useSurface(): void {
    this.fragmentShader = fragmentShader(this.#surface)
    Object.assign(this.uniforms, this.#surface.uniforms)
    this.#setDefines(this.#surface.defines)
    this.#setDefine('BASE', this.#surface.isPartial)
    this.#setDefine('GAMUT_MAPPED', this.#gamut === 'map')
    // The old surface's optics do not fit the new one's GLSL.
    this.#applied = null
    this.#setDefine('DIFFRACTION', false)
    this.needsUpdate = true
  }

  #apply(optics: Optics): void {
    this.#opticsVersion++
    const { defines, uniforms, environmentUniforms, underLights } = optics
    this.#opticsFeatures = optics.features
    this.#environmentFeatures = optics.environmentFeatures
    this.#environmentUniforms = environmentUniforms
    this.#environmentRefinement = optics.environmentRefinement
    this.#blursEnvironment = optics.blursEnvironment
    this.#refinementFrames = 0
    this.#underLights = underLights
    this.#largestRadius = -1
    this.#takeUniforms(uniforms)
    for (const name of this.#opticsDefines) if (!(name in defines)) this.#setDefine(name, false)
    this.#opticsDefines = Object.keys(defines)
    this.#setDefines(defines)
    this.#applied = { ...this.#settings }
    this.#setDefine('DIFFRACTION', this.#diffraction)
  }

  #takeUniforms(uniforms: Record<string, IUniform>): void {
    for (const [name, { value }] of Object.entries(uniforms)) {
      const uniform = (this.uniforms[name] ??= { value: null })
      // Frees small tables made for these settings alone. Where a shared one goes too, whoever still shows it
      // uploads it again with the next frame.
      if (uniform.value !== value) disposeTexture(uniform.value)
      uniform.value = value as unknown
      this.#opticsUniforms.add(name)
    }
  }

  /** Tables did not come: back to the settings of those in use. */
  #fail(error: DiffractionError): void {
    if (this.#applied !== null) Object.assign(this.#settings, this.#applied)
    this.onError(error)
  }

  #followLights(renderer: WebGLRenderer, scene: Object3D, camera: Camera): void {
    const { angularRadii, isTinted } = sceneLights(renderer, scene, camera)
    const radii = this.uniforms.uLightAngularRadii!.value as number[]
    radii.length = angularRadii.length
    let largest = 0
    for (let i = 0; i < radii.length; i++) {
      const radius = angularRadii[i]!
      radii[i] = Number.isNaN(radius) ? (this.#lightAngularRadius ?? 0) : radius
      largest = Math.max(largest, radii[i]!)
    }
    if (largest !== this.#largestRadius) this.#useLights(largest)
    this.#setDefine('TINTED', isTinted)
  }

  #useLights(largestRadius: number): void {
    this.#largestRadius = largestRadius
    const before = this.#lightOptics.defines
    this.#lightOptics = this.#underLights(largestRadius)
    const { defines } = this.#lightOptics
    for (const name of Object.keys({ ...before, ...defines }))
      this.#setDefine(name, defines[name] ?? false)
  }

  /** The material's environment before the scene's, as for three's own materials. */
  #followEnvironment(scene: Scene): EnvironmentMap | null {
    const isOwn = this.#envMap !== null
    const given = this.#envMap ?? environmentOf(scene)
    const environment = given === null ? null : environmentMap(given)
    this.#setDefine('ENVIRONMENT_EQUIRECT', environment !== null && !environment.isCube)
    this.#setDefine('ENVIRONMENT_CUBE', environment?.isCube === true)
    this.#environmentRepaired = environment?.repaired ?? 0
    if (environment === null) return null
    if (this.#environmentUniforms !== null) {
      this.#takeUniforms(this.#environmentUniforms())
      this.#environmentUniforms = null
    }
    this.#followRefinement(refinementFrame(scene))
    const { texture, isCube, texel } = environment
    const euler = isOwn ? this.envMapRotation : scene.environmentRotation
    const rotation = this.uniforms.uEnvironmentRotation!.value as Matrix3
    // The inverse of a rotation is its transpose: the texture turns with the angles, directions against them.
    rotation.setFromMatrix4(rotationMatrix.makeRotationFromEuler(euler)).transpose()
    if (isCube && !texture.isRenderTargetTexture) rotation.premultiply(mirrorX)
    this.uniforms.uEnvironmentMap!.value = texture
    this.#setNumber('uEnvironmentTexel', texel)
    this.#setNumber(
      'uEnvironmentIntensity',
      isOwn ? this.envMapIntensity : scene.environmentIntensity,
    )
    return environment
  }

  #followRefinement(frame: RefinementFrame | null): void {
    this.#isRefined = frame !== null
    const refinement = this.#environmentRefinement
    if (refinement === null) return
    if (frame !== null && frame.count !== this.#refinementFrames) {
      this.#refinementFrames = frame.count
      this.#takeUniforms(refinement.uniforms(frame.count))
    }
    this.#setNumber('uEnvironmentStart', frame === null ? 0 : refinement.start(frame))
  }

  /** After all that the table depends on. */
  #followPlane(
    renderer: WebGLRenderer,
    camera: Camera,
    geometry: BufferGeometry,
    object: Object3D,
  ): void {
    const { defines, uniforms } = this
    const hasEnvironment = 'ENVIRONMENT_EQUIRECT' in defines || 'ENVIRONMENT_CUBE' in defines
    const isIn =
      'DIFFRACTION' in defines &&
      this.#planar.follow({
        renderer,
        camera,
        object,
        geometry,
        side: this.side,
        gratings: this.#surface.planarGratings,
        obstacle: this.#planarObstacle(),
        environment: hasEnvironment ? (uniforms.uEnvironmentMap!.value as Texture) : null,
        rotation: uniforms.uEnvironmentRotation!.value as Matrix3,
        optics: { defines, uniforms },
        opticsVersion: this.#opticsVersion,
      })
    uniforms.uPlanarEnvironment!.value = this.#planar.texture
    this.#setDefine('PLANAR_TEXELS', isIn && floatLiteral(PLANAR_TEXELS))
  }

  /** After the flat table, in whose place the nodes are read. */
  #followBlur(renderer: WebGLRenderer, camera: Camera, environment: EnvironmentMap | null): void {
    const { defines, uniforms, roughness } = this
    const isIn =
      'DIFFRACTION' in defines &&
      this.#blursEnvironment &&
      !('PLANAR_TEXELS' in defines) &&
      this.#blurred.follow({ renderer, camera, environment, roughness })
    uniforms.uBlurredLayers!.value = this.#blurred.texture
    this.#setNumber('uBlurUnit', isIn ? BlurredEnvironment.unit(roughness) : 1)
    this.#setDefine('BLURRED_LAYERS', isIn && BLURRED_LAYERS)
  }

  get #blurWhy(): string {
    if (!this.#blursEnvironment) return 'the surface is smooth, or its method blurs by mip levels'
    if ('PLANAR_TEXELS' in this.defines) return 'a flat surface has its table'
    return this.#blurred.why
  }

  #planarObstacle(): string | null {
    if (!this.planarEnvironment) return 'planarEnvironment is false'
    if (this.#isRefined) return 'a refinement goes further than a table'
    if (this.method !== 'closed-form') return `method is '${this.method}'`
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

  #setDefines(defines: Record<string, string | number | boolean>): void {
    for (const [name, value] of Object.entries(defines)) this.#setDefine(name, value)
  }

  /**
   * Asks for another program only on change. three knows a program by the names and values of its defines in their order,
   * so those that are out are not among them, and the others are sorted: whatever came in between, a class of scene that
   * was drawn before finds its program.
   */
  #setDefine(name: string, value: string | number | boolean): void {
    const define = value === true ? '' : value
    if ((this.defines[name] ?? false) === define) return
    const defines = Object.entries({ ...this.defines, [name]: define })
    const included = defines.filter(([, kept]) => kept !== false)
    this.defines = Object.fromEntries(included.sort(([a], [b]) => (a < b ? -1 : 1)))
    this.needsUpdate = true
  }

  #number(name: string): number {
    return this.uniforms[name]!.value as number
  }

  #setNumber(name: string, value: number): void {
    this.uniforms[name]!.value = value
  }
}

/** What is drawn can be a mere mesh or group, without an environment. */
function environmentOf(scene: Partial<Scene>): Texture | null {
  return scene.environment ?? null
}

function disposeTexture(value: unknown): void {
  if (value instanceof Texture) value.dispose()
}
