import {
  BufferGeometry,
  Camera,
  Float32BufferAttribute,
  HalfFloatType,
  LinearFilter,
  Mesh,
  NoBlending,
  RGBAFormat,
  ShaderMaterial,
  Vector2,
  Vector3,
  WebGL3DRenderTarget,
  WebGLArrayRenderTarget,
  type IUniform,
  type Matrix3,
  type Texture,
  type WebGLRenderer,
  type WebGLRenderTarget,
} from 'three'
import { floatLiteral } from '../glsl/float-literal'
import { planarBlurShader, planarEnvironmentShader } from '../glsl/material-shaders'
import { gaussianTaps } from './gaussian-taps'

/** Texels along a side of a table. */
export const PLANAR_TEXELS = 192

/** Texels along a side of the blurred environment, and its layers from grazing to upright views. */
const BLUR_TEXELS = 256
const BLUR_LAYERS = 3

const X_AXIS = new Vector2(1, 0)
const Y_AXIS = new Vector2(0, 1)

const { taps, width } = gaussianTaps(17)

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
  readonly #blur = makeMaterial(planarBlurShader)
  readonly #radiance = makeMaterial(planarEnvironmentShader)
  readonly #mesh: Mesh<BufferGeometry, ShaderMaterial>
  readonly #camera = new Camera()

  /** @param layers - number of gratings */
  constructor(readonly layers: number) {
    this.#table = new WebGLArrayRenderTarget(PLANAR_TEXELS, PLANAR_TEXELS, layers, TARGET)
    const triangle = new BufferGeometry()
    const corners = [-1, -1, 0, 3, -1, 0, -1, 3, 0]
    triangle.setAttribute('position', new Float32BufferAttribute(corners, 3))
    this.#mesh = new Mesh(triangle, this.#blur)
    this.#mesh.frustumCulled = false
  }

  get texture(): Texture {
    return this.#table.texture
  }

  /** Whether the texture is on that renderer's GPU: a lost context takes it along. */
  isOn(renderer: WebGLRenderer): boolean {
    const { __webglFramebuffer } = renderer.properties.get(this.#table) as {
      __webglFramebuffer?: unknown
    }
    return __webglFramebuffer !== undefined
  }

  /**
   * Fills the table while a frame is being drawn: renders within a render. What the frame had set is there again
   * afterwards.
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
    frameCamera: Camera & { viewport?: unknown },
  ): void {
    const { autoClear, info, shadowMap, xr } = renderer
    const target = renderer.getRenderTarget()
    const face = renderer.getActiveCubeFace()
    const level = renderer.getActiveMipmapLevel()
    const before = {
      xr: xr.enabled,
      shadows: shadowMap.autoUpdate,
      reset: info.autoReset,
      frame: info.render.frame,
    }
    renderer.autoClear = false
    xr.enabled = false
    shadowMap.autoUpdate = false
    info.autoReset = false
    const alongX = blurTarget()
    const alongXY = blurTarget()
    try {
      take(this.#blur, optics, plane)
      this.#drawBlur(renderer, alongX, X_AXIS, null)
      this.#drawBlur(renderer, alongXY, Y_AXIS, alongX.texture)
      take(this.#radiance, optics, plane)
      this.#mesh.material = this.#radiance
      this.#radiance.uniforms.uBlurredEnvironment = { value: alongXY.texture }
      gratings.forEach((grating, layer) => {
        this.#radiance.uniforms.uGrating = { value: grating }
        this.#draw(renderer, this.#table, layer)
      })
    } finally {
      alongX.dispose()
      alongXY.dispose()
      renderer.autoClear = autoClear
      xr.enabled = before.xr
      shadowMap.autoUpdate = before.shadows
      info.autoReset = before.reset
      // Whoever counts frames would take what follows for another one.
      info.render.frame = before.frame
      renderer.setRenderTarget(target, face, level)
      // One eye's part of the picture.
      if (frameCamera.viewport !== undefined) renderer.state.viewport(frameCamera.viewport)
    }
  }

  dispose(): void {
    this.#table.dispose()
    this.#blur.dispose()
    this.#radiance.dispose()
    this.#mesh.geometry.dispose()
  }

  /** @param source - what is blurred along the other axis already; null: the environment itself */
  #drawBlur(
    renderer: WebGLRenderer,
    target: WebGLRenderTarget,
    axis: Vector2,
    source: Texture | null,
  ): void {
    this.#mesh.material = this.#blur
    for (let layer = 0; layer < BLUR_LAYERS; layer++) {
      Object.assign(this.#blur.uniforms, {
        uIsBlurred: { value: source !== null },
        uBlurredEnvironment: { value: source },
        uAxis: { value: axis },
        uCosine: { value: layer / (BLUR_LAYERS - 1) },
      })
      this.#draw(renderer, target, layer)
    }
  }

  #draw(renderer: WebGLRenderer, target: WebGLRenderTarget, layer: number): void {
    renderer.setRenderTarget(target, layer)
    renderer.render(this.#mesh, this.#camera)
  }
}

function blurTarget(): WebGL3DRenderTarget {
  return new WebGL3DRenderTarget(BLUR_TEXELS, BLUR_TEXELS, BLUR_LAYERS, TARGET)
}

function makeMaterial(shader: string): ShaderMaterial {
  return new ShaderMaterial({
    vertexShader: 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
    fragmentShader: shader,
    blending: NoBlending,
    depthTest: false,
    depthWrite: false,
    toneMapped: false,
  })
}

/** Gives a program the material's optics and what both programs share. */
function take(material: ShaderMaterial, { defines, uniforms }: PlanarOptics, plane: Matrix3): void {
  const wanted = {
    ...defines,
    PLANAR_TEXELS: floatLiteral(PLANAR_TEXELS),
    BLUR_TEXELS: floatLiteral(BLUR_TEXELS),
    BLUR_LAYERS: floatLiteral(BLUR_LAYERS),
    BLUR_TAPS: taps.length,
    TAP_WIDTH: floatLiteral(width),
  }
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
