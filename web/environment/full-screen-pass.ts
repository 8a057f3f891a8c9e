import {
  BufferGeometry,
  Camera,
  Float32BufferAttribute,
  Mesh,
  NoBlending,
  ShaderMaterial,
  type WebGLRenderer,
  type WebGLRenderTarget,
} from 'three'

/** Whether a renderer can draw to textures of half floats. */
export function drawsHalfFloats({ extensions }: WebGLRenderer): boolean {
  return extensions.has('EXT_color_buffer_float') || extensions.has('EXT_color_buffer_half_float')
}

/** Whether what was drawn is on that renderer's GPU: a lost context takes it along. */
export function isOn(renderer: WebGLRenderer, target: WebGLRenderTarget): boolean {
  const { __webglFramebuffer } = renderer.properties.get(target) as {
    __webglFramebuffer?: unknown
  }
  return __webglFramebuffer !== undefined
}

/** A program that writes every pixel of a target. */
export function fullScreenMaterial(fragmentShader: string): ShaderMaterial {
  return new ShaderMaterial({
    vertexShader: 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
    fragmentShader,
    blending: NoBlending,
    depthTest: false,
    depthWrite: false,
    toneMapped: false,
  })
}

/** Fills textures while a frame is being drawn: renders within a render. */
export class FullScreenPass {
  readonly #mesh: Mesh<BufferGeometry, ShaderMaterial>
  readonly #camera = new Camera()

  constructor() {
    const triangle = new BufferGeometry()
    const corners = [-1, -1, 0, 3, -1, 0, -1, 3, 0]
    triangle.setAttribute('position', new Float32BufferAttribute(corners, 3))
    this.#mesh = new Mesh(triangle)
    this.#mesh.frustumCulled = false
  }

  /**
   * Calls what draws. What the frame had set is there again afterwards, whatever is thrown.
   *
   * @param frameCamera - of the frame that is interrupted
   */
  interrupt(
    renderer: WebGLRenderer,
    frameCamera: Camera & { viewport?: unknown },
    draws: () => void,
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
      draws()
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

  /** @param layer - of a target that has several */
  draw(
    renderer: WebGLRenderer,
    target: WebGLRenderTarget,
    material: ShaderMaterial,
    layer = 0,
  ): void {
    this.#mesh.material = material
    renderer.setRenderTarget(target, layer)
    renderer.render(this.#mesh, this.#camera)
  }

  dispose(): void {
    this.#mesh.geometry.dispose()
  }
}
