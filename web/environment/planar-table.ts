import {
  HalfFloatType,
  LinearFilter,
  RGBAFormat,
  Vector2,
  WebGL3DRenderTarget,
  WebGLArrayRenderTarget,
  type Camera,
  type IUniform,
  type Matrix3,
  type ShaderMaterial,
  type Texture,
  type Vector3,
  type WebGLRenderer,
  type WebGLRenderTarget,
} from 'three'
import { floatLiteral } from '../glsl/float-literal.ts'
import { planarBlurShader, planarEnvironmentShader } from '../glsl/rough-environment-shaders.ts'
import { FullScreenPass, fullScreenMaterial, isOn } from './full-screen-pass.ts'
import { gaussianTaps } from './gaussian-taps.ts'

/** Texels along a side of a table. */
export const PLANAR_TEXELS = 192

/** Texels along a side of the blurred environment, and its layers from grazing to upright views. */
const BLUR_TEXELS = 256
const BLUR_LAYERS = 3

const X_AXIS = new Vector2(1, 0)
const Y_AXIS = new Vector2(0, 1)

const { taps, width } = gaussianTaps(17, true)

/** What a grating's radiance is computed from, besides plane and grating. */
export interface PlanarOptics {
  defines: Record<string, unknown>
  uniforms: Record<string, IUniform>
}

const TARGET = {
  type: HalfFloatType,
  format: RGBAFormat,
  minFilter: LinearFilter,
  magFilter: LinearFilter,
  depthBuffer: false,
}

/** The texture of shaders/planar-environment.glsl, and the programs that fill it. */
export class PlanarTable {
  readonly #table: WebGLArrayRenderTarget
  readonly #blur = fullScreenMaterial(planarBlurShader)
  readonly #radiance = fullScreenMaterial(planarEnvironmentShader)
  readonly #pass = new FullScreenPass()

  /** @param layers - number of gratings */
  constructor(readonly layers: number) {
    this.#table = new WebGLArrayRenderTarget(PLANAR_TEXELS, PLANAR_TEXELS, layers, TARGET)
  }

  get texture(): Texture {
    return this.#table.texture
  }

  isOn(renderer: WebGLRenderer): boolean {
    return isOn(renderer, this.#table)
  }

  /**
   * Fills the table while a frame is being drawn.
   *
   * @param plane - tangent, bitangent and normal as columns, world
   * @param gratings - cos θ, sin θ, frequency in 1/µm of every layer
   * @param frameCamera - of the frame
   */
  fill(
    renderer: WebGLRenderer,
    optics: PlanarOptics,
    plane: Matrix3,
    gratings: readonly Vector3[],
    frameCamera: Camera,
  ): void {
    const alongX = blurTarget()
    const alongXY = blurTarget()
    try {
      this.#pass.interrupt(renderer, frameCamera, () => {
        take(this.#blur, optics, plane)
        this.#drawBlur(renderer, alongX, X_AXIS, null)
        this.#drawBlur(renderer, alongXY, Y_AXIS, alongX.texture)
        take(this.#radiance, optics, plane)
        this.#radiance.uniforms.uBlurredEnvironment = { value: alongXY.texture }
        gratings.forEach((grating, layer) => {
          this.#radiance.uniforms.uGrating = { value: grating }
          this.#pass.draw(renderer, this.#table, this.#radiance, layer)
        })
      })
    } finally {
      alongX.dispose()
      alongXY.dispose()
    }
  }

  dispose(): void {
    this.#table.dispose()
    this.#blur.dispose()
    this.#radiance.dispose()
    this.#pass.dispose()
  }

  /** @param source - what is blurred along the other axis already; null: the environment itself */
  #drawBlur(
    renderer: WebGLRenderer,
    target: WebGLRenderTarget,
    axis: Vector2,
    source: Texture | null,
  ): void {
    for (let layer = 0; layer < BLUR_LAYERS; layer++) {
      Object.assign(this.#blur.uniforms, {
        uIsBlurred: { value: source !== null },
        uBlurredEnvironment: { value: source },
        uAxis: { value: axis },
        uCosine: { value: layer / (BLUR_LAYERS - 1) },
      })
      this.#pass.draw(renderer, target, this.#blur, layer)
    }
  }
}

function blurTarget(): WebGL3DRenderTarget {
  return new WebGL3DRenderTarget(BLUR_TEXELS, BLUR_TEXELS, BLUR_LAYERS, TARGET)
}

/** Gives a program the material's optics and what both programs share. */
function take(material: ShaderMaterial, { defines, uniforms }: PlanarOptics, plane: Matrix3): void {
  const wanted: Record<string, unknown> = {
    ...defines,
    PLANAR_TEXELS: floatLiteral(PLANAR_TEXELS),
    BLUR_TEXELS: floatLiteral(BLUR_TEXELS),
    BLUR_LAYERS: floatLiteral(BLUR_LAYERS),
    BLUR_TAPS: taps.length,
    TAP_WIDTH: floatLiteral(width),
  }
  // What fills the table blurs by itself.
  delete wanted.BLURRED_LAYERS
  if (JSON.stringify(wanted) !== JSON.stringify(material.defines)) {
    material.defines = wanted
    material.needsUpdate = true
  }
  Object.assign(material.uniforms, uniforms, {
    uPlane: { value: plane },
    uEnvironmentIntensity: { value: 1 },
    uTaps: { value: taps },
  })
}
