import {
  FloatType,
  HalfFloatType,
  LinearFilter,
  NoBlending,
  ShaderMaterial,
  Vector2,
  WebGLRenderTarget,
  type Camera,
  type Scene,
  type WebGLRenderer,
} from 'three'
import { FullScreenQuad } from 'three/addons/postprocessing/Pass.js'
import { refuse } from '../errors.ts'
import { jitteredProjection } from './jittered-projection.ts'
import { pixelOffsets } from './pixel-offsets.ts'
import { drawRefinementFrame } from './refinement-frame.ts'

const OWNER = 'ProgressiveRefinement'

/** The largest numbers of either kind, the first rounded down. */
const LARGEST = { float: 3.4e38, half: 65504 } as const

const vertexShader = /* glsl */ `
varying vec2 vUv;
void main() {
	vUv = uv;
	gl_Position = vec4(position.xy, 0.0, 1.0);
}`

/** The mean of the frames so far and one more, whose share is uWeight. What is in uMean before the first is not read. */
const meanShader = /* glsl */ `
uniform sampler2D uSample;
uniform sampler2D uMean;
uniform float uWeight;
uniform float uLargest;  // the largest number that both hold
void main() {
	ivec2 pixel = ivec2(gl_FragCoord.xy);
	vec4 color = min(texelFetch(uSample, pixel, 0), uLargest);
	gl_FragColor = uWeight < 1.0 ? mix(texelFetch(uMean, pixel, 0), color, uWeight) : color;
}`

/** Linear radiance in the renderer's tone mapping and colour space. */
const outputShader = /* glsl */ `
#include <common>
#include <dithering_pars_fragment>
uniform sampler2D uMean;
varying vec2 vUv;
void main() {
	gl_FragColor = texture2D(uMean, vUv);
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <dithering_fragment>
}`

/** How many frames, and whether edges are smoothed. */
export interface ProgressiveRefinementOptions {
  /** After how many frames the picture is finished: 16 by default, a power of 2 up to 1024. */
  frames?: number
  /** Whether a pixel shows the mean over its area, the default, or what is at its centre. */
  antialias?: boolean
}

/**
 * The mean of many frames of a scene at rest. In each, gratings and foils read their environment at wavelengths of their
 * own, so that the mean is as exact as one frame with that many times the nodes, and pixels' centres lie elsewhere in
 * them. It is a mean of linear radiance, as the light of a pixel is: one of tone-mapped colours would be smoother
 * where next to a glint there is none, but too dark there, and go towards no reference.
 */
export class ProgressiveRefinement {
  /** After how many frames the picture is finished. */
  readonly frames: number
  readonly #renderer: WebGLRenderer
  readonly #offsets: readonly [number, number][] | null
  readonly #sample: WebGLRenderTarget
  #mean: WebGLRenderTarget
  /** Where the next mean is written: a program cannot read what it writes. */
  #nextMean: WebGLRenderTarget
  readonly #addition: ShaderMaterial
  readonly #output: ShaderMaterial
  readonly #quad = new FullScreenQuad()
  #count = 0

  /**
   * Begins with frames as large as the renderer's canvas. Throws a DiffractionError where an option is out of range.
   *
   * @param renderer - that draws the scene; its tone mapping and colour space are those of the picture
   * @param options - how many frames, and whether edges are smoothed
   */
  constructor(
    renderer: WebGLRenderer,
    { frames = 16, antialias = true }: ProgressiveRefinementOptions = {},
  ) {
    this.frames = powerOfTwo(frames)
    this.#renderer = renderer
    this.#offsets = antialias ? pixelOffsets(this.frames) : null
    // Not all devices draw in floats and enlarge them smoothly; halves round the mean to about 1e-3.
    const isFloat = ['EXT_color_buffer_float', 'OES_texture_float_linear'].every((name) =>
      renderer.extensions.has(name),
    )
    const target = (depthBuffer: boolean): WebGLRenderTarget =>
      new WebGLRenderTarget(1, 1, {
        type: isFloat ? FloatType : HalfFloatType,
        minFilter: LinearFilter,
        magFilter: LinearFilter,
        depthBuffer,
      })
    this.#sample = target(true)
    this.#mean = target(false)
    this.#nextMean = target(false)
    this.#addition = new ShaderMaterial({
      vertexShader,
      fragmentShader: meanShader,
      uniforms: {
        uSample: { value: this.#sample.texture },
        uMean: { value: null },
        uWeight: { value: 1 },
        uLargest: { value: isFloat ? LARGEST.float : LARGEST.half },
      },
      ...OVERWRITING,
      toneMapped: false,
    })
    this.#output = new ShaderMaterial({
      vertexShader,
      fragmentShader: outputShader,
      uniforms: { uMean: { value: null } },
      ...OVERWRITING,
      // Dark backgrounds would show their steps of 8 bits.
      dithering: true,
    })
    this.begin()
  }

  /** Number of frames in the mean. */
  get count(): number {
    return this.#count
  }

  /** The mean: linear radiance and coverage. The next frame has another one. */
  get mean(): WebGLRenderTarget {
    return this.#mean
  }

  /**
   * Forgets the mean, because something has changed.
   *
   * @param width - of the frames, pixels; the canvas' by default
   * @param height - of the frames, pixels; likewise
   */
  begin(width?: number, height?: number): void {
    const canvas = this.#renderer.getDrawingBufferSize(new Vector2())
    for (const target of [this.#sample, this.#mean, this.#nextMean])
      target.setSize(width ?? canvas.x, height ?? canvas.y)
    this.#count = 0
  }

  /**
   * Adds a frame to the mean, unless the picture is finished. Draws nothing to the canvas: see `show`.
   *
   * @param scene - the same as in the frames before
   * @param camera - likewise; perspective or orthographic
   * @returns whether more are needed
   */
  frame(scene: Scene, camera: Camera): boolean {
    if (this.#count >= this.frames) return false
    const renderer = this.#renderer
    const before = renderer.getRenderTarget()
    const [x, y] = this.#offsets?.[this.#count] ?? [0, 0]
    const { width, height } = this.#sample
    renderer.setRenderTarget(this.#sample)
    renderer.clear()
    jitteredProjection(camera, (2 * x) / width, (2 * y) / height, () => {
      drawRefinementFrame(scene, { index: this.#count, count: this.frames }, () => {
        renderer.render(scene, camera)
      })
    })

    this.#count++
    const { uMean, uWeight } = this.#addition.uniforms
    uMean!.value = this.#mean.texture
    uWeight!.value = 1 / this.#count
    renderer.setRenderTarget(this.#nextMean)
    this.#draw(this.#addition)
    ;[this.#mean, this.#nextMean] = [this.#nextMean, this.#mean]
    renderer.setRenderTarget(before)
    return this.#count < this.frames
  }

  /** Draws the mean to the canvas, or the render target that is set, in the renderer's tone mapping and colour space. */
  show(): void {
    this.#output.uniforms['uMean']!.value = this.#mean.texture
    this.#draw(this.#output)
  }

  /** Frees render targets and programs. */
  dispose(): void {
    for (const target of [this.#sample, this.#mean, this.#nextMean]) target.dispose()
    for (const material of [this.#addition, this.#output]) material.dispose()
    this.#quad.dispose()
  }

  #draw(material: ShaderMaterial): void {
    this.#quad.material = material
    this.#quad.render(this.#renderer)
  }
}

const OVERWRITING = { blending: NoBlending, depthTest: false, depthWrite: false } as const

/** Frames share nodes out by halves, again and again. */
function powerOfTwo(frames: unknown): number {
  if (
    typeof frames === 'number' &&
    frames <= 1024 &&
    Number.isInteger(Math.log2(frames)) &&
    frames >= 1
  )
    return frames
  refuse(OWNER, 'frames', frames, 'a power of 2 from 1 to 1024')
}
