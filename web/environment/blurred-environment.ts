import {
  HalfFloatType,
  LinearFilter,
  RepeatWrapping,
  RGBAFormat,
  Vector2,
  Vector3,
  WebGL3DRenderTarget,
  WebGLRenderTarget,
  type Camera,
  type ShaderMaterial,
  type Texture,
  type WebGLRenderer,
} from 'three'
import { environmentBlurShader } from '../glsl/rough-environment-shaders.ts'
import type { EnvironmentMap } from './environment-map.ts'
import { drawsHalfFloats, FullScreenPass, fullScreenMaterial, isOn } from './full-screen-pass.ts'
import { gaussianTaps } from './gaussian-taps.ts'

/** Layers of shaders/blurred-environment.glsl. */
export const BLURRED_LAYERS = 8

/**
 * Deviation of the second layer over the surface's roughness: w, by which tilts move a direction in the plane, is seldom
 * less. With a doubled variance each the last layer has four times the roughness, twice what any order needs.
 */
const SHARPEST = 0.5

/** A surface that blurs by less than this share of a texel gains nothing over the mip levels of the environment. */
const LEAST_BLUR = 0.5

/** Texels along the horizon, at most: 34 MB of layers. */
const MOST_TEXELS = 1024

/** Over what the layers hold: BLURRED_RADIANCE of shaders/blurred-environment.glsl. */
const RADIANCE = 16

const { taps } = gaussianTaps(7, false)

const TARGET = {
  type: HalfFloatType,
  format: RGBAFormat,
  minFilter: LinearFilter,
  magFilter: LinearFilter,
  wrapS: RepeatWrapping,
  depthBuffer: false,
}

/** What a material knows of a draw. */
export interface BlurDraw {
  renderer: WebGLRenderer
  camera: Camera
  /** Null where there is none. */
  environment: EnvironmentMap | null
  /** rad */
  roughness: number
}

/** The environment blurred for one roughness: makes the texture when the environment or the roughness is another. */
export class BlurredEnvironment {
  /** Why the last draw had a texture or none. */
  why = 'nothing has been drawn'
  #layers: WebGL3DRenderTarget | null = null
  /** What the layers were made for. */
  #made: readonly unknown[] = []
  readonly #pass = new FullScreenPass()
  readonly #copy = fullScreenMaterial(environmentBlurShader)
  readonly #blur = fullScreenMaterial(environmentBlurShader)

  get texture(): Texture | null {
    return this.#layers?.texture ?? null
  }

  /** Whether the draw can read the layers, which may be made now. */
  follow(draw: BlurDraw): boolean {
    const obstacle = this.#obstacle(draw)
    this.why = obstacle ?? 'Gaussians, as tilts of the surface blur it'
    if (obstacle !== null) return false
    const { renderer, environment, roughness } = draw
    const { texture, isCube } = environment!
    const needed = [renderer, texture, texture.version, isCube, roughness]
    const isMade = needed.every((thing, i) => thing === this.#made[i])
    if (!isMade || !isOn(renderer, this.#layers!)) {
      this.#make(draw, environment!)
      this.#made = needed
    }
    return true
  }

  /** 1 over the second layer's variance, 1/rad². */
  static unit(roughness: number): number {
    return 1 / (SHARPEST * roughness) ** 2
  }

  dispose(): void {
    this.#layers?.dispose()
    this.#layers = null
    this.#made = []
    this.#copy.dispose()
    this.#blur.dispose()
    this.#pass.dispose()
  }

  #obstacle({ renderer, environment, roughness }: BlurDraw): string | null {
    if (environment === null) return 'there is no environment'
    if (roughness === 0) return 'the surface is smooth'
    if (roughness < LEAST_BLUR * texelOf(environment, roughness))
      return 'the blur is less than a texel'
    if (environment.texture.isRenderTargetTexture)
      return 'the environment is drawn, and may change unseen'
    if (!drawsHalfFloats(renderer)) return 'the device cannot draw to half floats'
    return null
  }

  #make({ renderer, camera, roughness }: BlurDraw, environment: EnvironmentMap): void {
    const sharpest = SHARPEST * roughness
    const gl = renderer.getContext() as WebGL2RenderingContext
    const longest = gl.getParameter(gl.MAX_3D_TEXTURE_SIZE) as number
    const texel = Math.max(texelOf(environment, roughness), (2 * Math.PI) / longest)
    const height = Math.round(Math.PI / texel)
    const [width, unit] = [2 * height, sharpest ** 2]
    this.#layers?.dispose()
    this.#layers = new WebGL3DRenderTarget(width, height, BLURRED_LAYERS, TARGET)
    let [from, to] = [0, 1].map(() => new WebGLRenderTarget(width, height, TARGET)) as [
      WebGLRenderTarget,
      WebGLRenderTarget,
    ]
    const size = new Vector2(width, height)
    take(this.#copy, environment.isCube, [new Vector2(0, 1)], size)
    take(this.#blur, false, taps, size)
    Object.assign(this.#copy.uniforms, {
      uEnvironmentMap: { value: environment.texture },
      uEnvironmentIntensity: { value: 1 / RADIANCE },
      uLevel: { value: Math.log2(texel / environment.texel) },
    })
    // A texel read bilinearly is a triangle of this variance along an axis, and so is what is read of the environment.
    const tent = texel ** 2 / 6
    let before = texel ** 2 / 4 - environment.texel ** 2 / 4
    try {
      this.#pass.interrupt(renderer, camera, () => {
        renderer.initRenderTarget(this.#layers!)
        for (let layer = 0; layer < BLURRED_LAYERS; layer++) {
          const variance = unit * 2 ** (layer - 1)
          if (layer > 0) {
            const deviation = Math.sqrt(Math.max(variance - before - tent, 0))
            before = Math.max(variance, before + tent)
            this.#blur.uniforms.uDeviation = { value: deviation }
            this.#blur.uniforms.uEnvironmentMap = { value: from.texture }
          }
          this.#pass.draw(renderer, to, layer === 0 ? this.#copy : this.#blur)
          const place = new Vector3(0, 0, layer)
          renderer.copyTextureToTexture(to.texture, this.#layers!.texture, null, place)
          ;[from, to] = [to, from]
        }
      })
    } finally {
      from.dispose()
      to.dispose()
    }
  }
}

/** Of the layers, rad: the environment's own, or what their blur and memory ask for. */
function texelOf({ texel }: EnvironmentMap, roughness: number): number {
  return Math.max(texel, SHARPEST * roughness, (2 * Math.PI) / MOST_TEXELS)
}

function take(material: ShaderMaterial, isCube: boolean, taps: Vector2[], size: Vector2): void {
  const source = isCube ? 'ENVIRONMENT_CUBE' : 'ENVIRONMENT_EQUIRECT'
  if (material.defines[source] === undefined || material.defines.BLUR_TAPS !== taps.length) {
    material.defines = { [source]: '', BLUR_TAPS: taps.length }
    material.needsUpdate = true
  }
  Object.assign(material.uniforms, {
    uEnvironmentIntensity: { value: 1 },
    uSize: { value: size },
    uDeviation: { value: 0 },
    uBlurTaps: { value: taps },
    uLevel: { value: 0 },
  })
}
