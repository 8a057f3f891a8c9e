import {
  HalfFloatType,
  NoBlending,
  NormalBlending,
  ShaderMaterial,
  WebGLRenderTarget,
  type PerspectiveCamera,
  type Scene,
  type WebGLRenderer,
} from 'three'
import { FullScreenQuad } from 'three/addons/postprocessing/Pass.js'

const vertexShader = /* glsl */ `
varying vec2 vUv;
void main() {
  vUv = uv;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`

/**
 * The mean is taken of c/(1 + largest channel), from 0 to 1, and undone afterwards: of radiances themselves, one glint
 * would outshine all samples that miss it, and bright edges would stay jagged. 500 is left apart from the largest half
 * float below 1.
 */
const blendShader = /* glsl */ `
uniform sampler2D uSample;
uniform float uWeight;
varying vec2 vUv;
void main() {
  vec3 color = min(texture2D(uSample, vUv).rgb, 500.0);
  gl_FragColor = vec4(color / (1.0 + max(color.r, max(color.g, color.b))), uWeight);
}`

const outputShader = /* glsl */ `
#include <common>
#include <dithering_pars_fragment>
uniform sampler2D uMean;
varying vec2 vUv;
void main() {
  vec3 color = texture2D(uMean, vUv).rgb;
  gl_FragColor = vec4(color / max(1.0 - max(color.r, max(color.g, color.b)), 1e-3), 1.0);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
  #include <dithering_fragment>
}`

/** The mean of frames whose pixels' centres are moved about: no jagged edges, at any number of them. */
export class Accumulator {
  readonly #sample = new WebGLRenderTarget(1, 1, { type: HalfFloatType })
  readonly #mean = new WebGLRenderTarget(1, 1, { type: HalfFloatType, depthBuffer: false })
  readonly #blend = new ShaderMaterial({
    vertexShader,
    fragmentShader: blendShader,
    uniforms: { uSample: { value: this.#sample.texture }, uWeight: { value: 1 } },
    blending: NormalBlending,
    transparent: true,
    depthTest: false,
    depthWrite: false,
    toneMapped: false,
  })
  readonly #output = new ShaderMaterial({
    vertexShader,
    fragmentShader: outputShader,
    uniforms: { uMean: { value: this.#mean.texture } },
    // Dark backgrounds would show their steps of 8 bits.
    dithering: true,
    blending: NoBlending,
    depthTest: false,
    depthWrite: false,
  })
  readonly #quad = new FullScreenQuad()
  #count = 0

  constructor(private readonly renderer: WebGLRenderer) {}

  /** Number of frames in the mean. */
  get count(): number {
    return this.#count
  }

  /** Begins anew, with frames of this size in pixels. */
  start(width: number, height: number): void {
    this.#sample.setSize(width, height)
    this.#mean.setSize(width, height)
    this.#count = 0
  }

  /** Draws one more frame into the mean. */
  add(scene: Scene, camera: PerspectiveCamera): void {
    const { width, height } = this.#sample
    // The first frame is drawn from the middle of each pixel.
    const [x, y] = [halton(this.#count, 2), halton(this.#count, 3)]
    camera.setViewOffset(width, height, x, y, width, height)
    this.renderer.setRenderTarget(this.#sample)
    this.renderer.clear()
    this.renderer.render(scene, camera)
    camera.clearViewOffset()

    this.#count++
    this.#blend.uniforms['uWeight']!.value = 1 / this.#count
    this.renderer.setRenderTarget(this.#mean)
    this.#draw(this.#blend)
    this.renderer.setRenderTarget(null)
  }

  /** Draws the mean to the canvas, in the renderer's tone mapping and colour space. */
  show(): void {
    this.#draw(this.#output)
  }

  #draw(material: ShaderMaterial): void {
    this.#quad.material = material
    this.#quad.render(this.renderer)
  }
}

/** The i-th number of the Halton sequence to a base, −0.5 to 0.5; the 0th is 0. */
function halton(i: number, base: number): number {
  if (i === 0) return 0
  let value = 0
  for (let digit = i, place = 1 / base; digit > 0; digit = Math.floor(digit / base), place /= base)
    value += (digit % base) * place
  return value - 0.5
}
