import { FloatType, HalfFloatType, PointLight, WebGLRenderTarget, DataUtils } from 'three'
import type { Demo } from '../demo'
import type { Colour } from './optics/light-spectrum'
import type { RenderedColour } from './pictures/spectra'

export interface Pixel {
  column: number
  row: number
}

/** Renders single pixels of the view as the page does, before tone mapping. */
export class RenderedPixel {
  readonly #target: WebGLRenderTarget
  readonly #isFloat: boolean

  constructor(private readonly demo: Demo) {
    this.#isFloat = demo.viewer.renderer.extensions.has('EXT_color_buffer_float')
    this.#target = new WebGLRenderTarget(1, 1, { type: this.#isFloat ? FloatType : HalfFloatType })
  }

  /** @param pixel - of the canvas, from its left and top */
  async read(pixel: Pixel): Promise<RenderedColour> {
    const light = this.demo.flash.object.getObjectByName('flash')
    if (!(light instanceof PointLight)) throw new Error('The flash has no light')
    const all = this.#render(pixel)
    // Not hidden: a scene with another number of lights is another program.
    const { intensity } = light
    light.intensity = 0
    const without = this.#render(pixel)
    light.intensity = intensity
    const [lit, unlit] = await Promise.all([all, without])
    return { all: lit, flash: lit.map((value, c) => value - unlit[c]!) as Colour }
  }

  #render({ column, row }: Pixel): Promise<Colour> {
    const { renderer, scene, camera } = this.demo.viewer
    const { width, height } = renderer.domElement
    const before = renderer.getRenderTarget()
    camera.setViewOffset(width, height, column, row, 1, 1)
    renderer.setRenderTarget(this.#target)
    renderer.clear()
    renderer.render(scene, camera)
    renderer.setRenderTarget(before)
    camera.clearViewOffset()
    return this.#read()
  }

  async #read(): Promise<Colour> {
    const texel = this.#isFloat ? new Float32Array(4) : new Uint16Array(4)
    await this.demo.viewer.renderer.readRenderTargetPixelsAsync(this.#target, 0, 0, 1, 1, texel)
    return Array.from(texel.subarray(0, 3), (value) =>
      this.#isFloat ? value : DataUtils.fromHalfFloat(value),
    ) as Colour
  }
}
