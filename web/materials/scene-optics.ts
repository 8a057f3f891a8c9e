import {
  Matrix3,
  Matrix4,
  type BufferGeometry,
  type Camera,
  type Euler,
  type IUniform,
  type Object3D,
  type Scene,
  type Side,
  type Texture,
  type WebGLRenderer,
} from 'three'
import { environmentMap, type EnvironmentMap } from '../environment/environment-map.ts'
import type { RoughEnvironment, RoughReasons } from '../environment/rough-environment.ts'
import { roughEnvironment } from '../lazy-code.ts'
import { refinementFrame, type RefinementFrame } from '../refinement/refinement-frame.ts'
import type {
  EnvironmentRefinement,
  Feature,
  LightOptics,
  Optics,
  OpticsSettings,
  Surface,
} from '../surfaces/surface.ts'
import type { Defines } from './defines.ts'
import { describeScene } from './features.ts'
import type { OpticsLoader } from './optics-loader.ts'
import { sceneLights } from './scene-lights.ts'
import { UsedTextures } from './used-textures.ts'

const rotationMatrix = new Matrix4()
/** Cube textures that were not rendered keep the left-handed axes of their images. */
const mirrorX = new Matrix3().set(-1, 0, 0, 0, 1, 0, 0, 0, 1)

/** An environment in place of the scene's. */
export interface OwnEnvironment {
  map: Texture
  intensity: number
  rotation: Euler
}

/** What a material knows of a draw. */
export interface SceneDraw {
  renderer: WebGLRenderer
  scene: Scene
  camera: Camera
  geometry: BufferGeometry
  object: Object3D
  side: Side
  settings: Readonly<OpticsSettings>
  /** Null where the scene's serves. */
  environment: OwnEnvironment | null
  /** Why the material rules out the table of a flat mesh; null where it does not. */
  obstacle: string | null
  /** Of lights that state none, rad. */
  lightRadius: number
}

/** Optics in a scene: the defines and uniforms that surface, lights and environment ask for, in step with each draw. */
export class SceneOptics {
  #surface!: Surface
  #optics: Optics | null = null
  /** Counts the optics that were taken over. */
  #version = 0
  #isOn = true
  #opticsDefines: string[] = []
  #opticsUniforms: Record<string, IUniform> = {}
  readonly #textures = new UsedTextures()
  /** Whether a draw may need other textures than the one before. */
  #hasOtherTextures = false
  /** Whether the environment's uniforms of the optics are still to be made. */
  #lacksEnvironment = false
  /** Whether the last frame drawn was one of a refinement. */
  #isRefined = false
  /** How many frames of a refinement the uniforms serve; 0: of none. */
  #refinementFrames = 0
  /** What the lights of the last frame drawn asked of the optics. */
  #lightOptics: LightOptics = { defines: {}, features: [] }
  #largestRadius = -1
  #environmentRepaired = 0
  /** Null until a rough surface has been drawn. */
  #rough: RoughEnvironment | null = null

  /**
   * @param name - of the material, for errors
   * @param defines - of the program; others may be among them
   * @param uniforms - likewise; those of the optics are put here
   */
  constructor(
    private readonly name: string,
    readonly defines: Defines,
    readonly uniforms: Record<string, IUniform>,
  ) {
    Object.assign(uniforms, {
      uLightAngularRadii: { value: [] as number[] },
      uEnvironmentMap: { value: null },
      uEnvironmentRotation: { value: new Matrix3() },
      uEnvironmentIntensity: { value: 1 },
      uEnvironmentTexel: { value: 1 },
      uPlanarEnvironment: { value: null },
      uBlurredLayers: { value: null },
      uBlurUnit: { value: 1 },
    })
  }

  /** Whether the surface diffracts, once there are optics. */
  get isOn(): boolean {
    return this.#isOn
  }

  set isOn(value: boolean) {
    this.#isOn = value
    this.defines.set('DIFFRACTION', this.#optics !== null && value)
  }

  /** Takes over a surface, whose optics are to come if it is new, or what it has changed. */
  useSurface(surface: Surface, isNew: boolean): void {
    this.#surface = surface
    this.defines.setAll(surface.defines)
    if (!isNew) return
    Object.assign(this.uniforms, surface.uniforms)
    this.#opticsUniforms = {}
    this.#hasOtherTextures = true
    this.#optics = null
    this.#lacksEnvironment = false
    this.defines.set('DIFFRACTION', false)
  }

  useOptics(optics: Optics): void {
    for (const name of this.#opticsDefines)
      if (!(name in optics.defines)) this.defines.set(name, false)
    this.#opticsDefines = Object.keys(optics.defines)
    this.#optics = optics
    this.#version++
    this.#lacksEnvironment = true
    this.#refinementFrames = 0
    this.#largestRadius = -1
    this.#opticsUniforms = {}
    this.#takeUniforms(optics.uniforms)
    this.defines.setAll(optics.defines)
    this.defines.set('DIFFRACTION', this.#isOn)
  }

  /** Before each draw. */
  follow(draw: SceneDraw): void {
    this.#followLights(draw)
    const environment = this.#followEnvironment(draw)
    if (this.#hasOtherTextures) this.#useTextures()
    this.#followRoughness(draw, environment)
  }

  explain(state: OpticsLoader['state'], error: Error | null, settings: OpticsSettings): Feature[] {
    return describeScene({
      defines: this.defines.values,
      opticsFeatures: [...(this.#optics?.features ?? []), ...this.#lightOptics.features],
      environmentFeatures: this.#optics?.environmentFeatures ?? [],
      environmentRepaired: this.#environmentRepaired,
      roughWhy: this.#rough?.why ?? whyNotRough(settings),
      isOn: this.#isOn,
      state,
      error,
      surfaceName: this.#surface.name,
      lights: (this.uniforms.uLightAngularRadii!.value as number[]).length,
    })
  }

  /** Frees the textures of surface, optics and environment that nobody else shows. */
  dispose(): void {
    this.#rough?.dispose()
    this.#textures.use([])
    this.#hasOtherTextures = true
  }

  #takeUniforms(uniforms: Record<string, IUniform>): void {
    for (const [name, { value }] of Object.entries(uniforms))
      (this.uniforms[name] ??= { value: null }).value = value as unknown
    Object.assign(this.#opticsUniforms, uniforms)
    this.#hasOtherTextures = true
  }

  /** In a draw, where textures are uploaded: a material that is never drawn, nor disposed of, keeps none alive. */
  #useTextures(): void {
    this.#textures.use(Object.values({ ...this.#surface.uniforms, ...this.#opticsUniforms }))
    this.#hasOtherTextures = false
  }

  #followLights({ renderer, scene, camera, lightRadius }: SceneDraw): void {
    const { angularRadii, isTinted } = sceneLights(renderer, scene, camera)
    const radii = this.uniforms.uLightAngularRadii!.value as number[]
    radii.length = angularRadii.length
    let largest = 0
    for (let i = 0; i < radii.length; i++) {
      const radius = angularRadii[i]!
      radii[i] = Number.isNaN(radius) ? lightRadius : radius
      largest = Math.max(largest, radii[i]!)
    }
    if (largest !== this.#largestRadius) this.#useLights(largest)
    this.defines.set('TINTED', isTinted)
  }

  #useLights(largestRadius: number): void {
    this.#largestRadius = largestRadius
    const before = this.#lightOptics.defines
    this.#lightOptics = this.#optics?.underLights(largestRadius) ?? { defines: {}, features: [] }
    const { defines } = this.#lightOptics
    for (const name of Object.keys({ ...before, ...defines }))
      this.defines.set(name, defines[name] ?? false)
  }

  /** The material's environment before the scene's, as for three's own materials. */
  #followEnvironment({ scene, environment: own }: SceneDraw): EnvironmentMap | null {
    const given = own?.map ?? environmentOf(scene)
    const environment = given === null ? null : environmentMap(given, this.name)
    this.defines.set('ENVIRONMENT_EQUIRECT', environment !== null && !environment.isCube)
    this.defines.set('ENVIRONMENT_CUBE', environment?.isCube === true)
    this.#environmentRepaired = environment?.repaired ?? 0
    if (environment === null) return null
    if (this.#lacksEnvironment) {
      this.#takeUniforms(this.#optics!.environmentUniforms())
      this.#lacksEnvironment = false
    }
    this.#followRefinement(refinementFrame(scene))
    const { texture, isCube, texel } = environment
    const rotation = this.uniforms.uEnvironmentRotation!.value as Matrix3
    // The inverse of a rotation is its transpose: the texture turns with the angles, directions against them.
    rotation
      .setFromMatrix4(
        rotationMatrix.makeRotationFromEuler(own?.rotation ?? scene.environmentRotation),
      )
      .transpose()
    if (isCube && !texture.isRenderTargetTexture) rotation.premultiply(mirrorX)
    this.uniforms.uEnvironmentMap!.value = texture
    this.uniforms.uEnvironmentTexel!.value = texel
    this.uniforms.uEnvironmentIntensity!.value = own?.intensity ?? scene.environmentIntensity
    return environment
  }

  #followRefinement(frame: RefinementFrame | null): void {
    this.#isRefined = frame !== null
    const refinement: EnvironmentRefinement | null = this.#optics?.environmentRefinement ?? null
    if (refinement === null) return
    if (frame !== null && frame.count !== this.#refinementFrames) {
      this.#refinementFrames = frame.count
      this.#takeUniforms(refinement.uniforms(frame.count))
    }
    this.uniforms.uEnvironmentStart!.value = frame === null ? 0 : refinement.start(frame)
  }

  /** After all that its table depends on. */
  #followRoughness(draw: SceneDraw, environment: EnvironmentMap | null): void {
    const { roughness } = draw.settings
    if (this.#rough === null) {
      const { code } = roughEnvironment
      if (code === null || roughness === 0) return
      this.#rough = new code.RoughEnvironment()
    }
    this.defines.setAll(
      this.#rough.follow({
        ...draw,
        environment,
        gratings: this.#surface.planarGratings,
        obstacle: this.#planarObstacle(draw),
        blurs: this.#optics?.blursEnvironment === true,
        roughness,
        defines: this.defines.values,
        uniforms: this.uniforms,
        opticsVersion: this.#version,
      }),
    )
  }

  #planarObstacle({ obstacle, settings }: SceneDraw): string | null {
    if (obstacle !== null) return obstacle
    if (this.#isRefined) return 'a refinement goes further than a table'
    return settings.method === 'closed-form' ? null : `method is '${settings.method}'`
  }
}

function whyNotRough({ roughness, method }: OpticsSettings): RoughReasons {
  let why = 'nothing has been drawn'
  if (roughness === 0) why = 'roughness is 0'
  else if (method !== 'closed-form') why = `method is '${method}'`
  return { planar: why, blur: why }
}

/** What is drawn can be a mere mesh or group, without an environment. */
function environmentOf(scene: Partial<Scene>): Texture | null {
  return scene.environment ?? null
}
