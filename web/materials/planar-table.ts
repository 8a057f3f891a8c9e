import {
  BufferGeometry,
  Camera,
  Float32BufferAttribute,
  HalfFloatType,
  LinearFilter,
  Matrix3,
  Mesh,
  NoBlending,
  RGBAFormat,
  ShaderMaterial,
  Vector3,
  WebGLArrayRenderTarget,
  type Camera as AnyCamera,
  type DataArrayTexture,
  type IUniform,
  type WebGLRenderer,
} from 'three'
import { floatLiteral } from '../glsl/float-literal'
import { planarEnvironmentShader } from '../glsl/material-shaders'
import { REST_OF_ROUGHNESS, tilts } from './tilts'

/** Texels along a side of a table. */
export const PLANAR_TEXELS = 128

const VERTEX_SHADER = 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }'

/** What a grating's radiance is computed from, besides plane and grating. */
export interface PlanarOptics {
  defines: Record<string, unknown>
  uniforms: Record<string, IUniform>
  roughness: number
}

/** The texture of shaders/planar-environment.glsl, and the program that fills it. */
export class PlanarTable {
  readonly #target: WebGLArrayRenderTarget
  readonly #material: ShaderMaterial
  readonly #mesh: Mesh
  readonly #camera = new Camera()

  /** @param layers - number of gratings */
  constructor(readonly layers: number) {
    this.#target = new WebGLArrayRenderTarget(PLANAR_TEXELS, PLANAR_TEXELS, layers, {
      type: HalfFloatType,
      format: RGBAFormat,
      minFilter: LinearFilter,
      magFilter: LinearFilter,
      depthBuffer: false,
    })
    this.#material = new ShaderMaterial({
      vertexShader: VERTEX_SHADER,
      fragmentShader: planarEnvironmentShader,
      blending: NoBlending,
      depthTest: false,
      depthWrite: false,
      toneMapped: false,
    })
    const triangle = new BufferGeometry()
    triangle.setAttribute(
      'position',
      new Float32BufferAttribute([-1, -1, 0, 3, -1, 0, -1, 3, 0], 3),
    )
    this.#mesh = new Mesh(triangle, this.#material)
    this.#mesh.frustumCulled = false
  }

  get texture(): DataArrayTexture {
    return this.#target.texture
  }

  /** Whether the texture is on that renderer's GPU: a lost context takes it along. */
  isOn(renderer: WebGLRenderer): boolean {
    const { __webglFramebuffer } = renderer.properties.get(this.#target) as {
      __webglFramebuffer?: unknown
    }
    return __webglFramebuffer !== undefined
  }

  /** Takes over what all the layers share. */
  prepare({ defines, uniforms, roughness }: PlanarOptics, plane: Matrix3): void {
    const corners = tilts(roughness)
    const wanted = {
      ...defines,
      PLANAR_TEXELS: floatLiteral(PLANAR_TEXELS),
      PLANAR_TILTS: corners.length,
    }
    if (JSON.stringify(wanted) !== JSON.stringify(this.#material.defines)) {
      this.#material.defines = wanted
      this.#material.needsUpdate = true
    }
    Object.assign(this.#material.uniforms, uniforms, {
      uRoughness: { value: REST_OF_ROUGHNESS * roughness },
      uEnvironmentIntensity: { value: 1 },
      uPlane: { value: plane },
      uGrating: { value: new Vector3() },
      uTilts: { value: corners },
    })
  }

  /**
   * Fills layers while a frame is being drawn: three renders within a render. What the frame had set is there again
   * afterwards.
   *
   * @param gratings - cos θ, sin θ, frequency in 1/µm of every layer
   * @param first - number of the first layer to fill
   * @param end - number after that of the last one
   * @param frameCamera - of the frame
   */
  fill(
    renderer: WebGLRenderer,
    gratings: readonly Vector3[],
    first: number,
    end: number,
    frameCamera: AnyCamera & { viewport?: unknown },
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
    try {
      for (let layer = first; layer < end; layer++) {
        ;(this.#material.uniforms.uGrating!.value as Vector3).copy(gratings[layer]!)
        renderer.setRenderTarget(this.#target, layer)
        renderer.render(this.#mesh, this.#camera)
      }
    } finally {
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
    this.#target.dispose()
    this.#material.dispose()
    this.#mesh.geometry.dispose()
  }
}
