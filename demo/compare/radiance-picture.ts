import { FloatType, WebGLRenderTarget } from 'three'
import type { Viewer } from '../view/viewer'
import { drawRadiance, type Way } from './draw-radiance'

/** Pixels of its width: a small picture is drawn quickly, and shows all of the object. */
const WIDTH = 240

/** Linear sRGB and coverage, rows from below. */
export interface RadiancePicture {
  width: number
  height: number
  /** Four numbers a pixel. */
  pixels: Float32Array
}

/** A small picture of the view, one frame; null where the device draws in no floats. */
export function radiancePicture(viewer: Viewer, way: Way): RadiancePicture | null {
  if (!viewer.renderer.extensions.has('EXT_color_buffer_float')) return null
  const height = Math.max(Math.round(WIDTH / viewer.camera.aspect), 1)
  const target = new WebGLRenderTarget(WIDTH, height, { type: FloatType })
  try {
    drawRadiance(viewer, target, way)
    const pixels = new Float32Array(4 * WIDTH * height)
    viewer.renderer.readRenderTargetPixels(target, 0, 0, WIDTH, height, pixels)
    return { width: WIDTH, height, pixels }
  } finally {
    target.dispose()
  }
}
