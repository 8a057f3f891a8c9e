import { FloatType, WebGLRenderTarget } from 'three'
import type { Viewer } from '../view/viewer'
import { drawRadiance, type Way } from './draw-radiance'

/** Pixels of the pictures' width: a small picture is drawn quickly, and shows all of the object. */
const WIDTH = 240

/**
 * Relative root mean square difference of linear radiance between two ways to draw the scene, one frame each: that of
 * the second from the first, over the root mean square of the second, over all pixels that the object covers. null
 * where the device draws in no floats or nothing is covered.
 */
export function pictureDifference(viewer: Viewer, ways: readonly [Way, Way]): number | null {
  if (!viewer.renderer.extensions.has('EXT_color_buffer_float')) return null
  const [first, second] = ways.map((way) => radianceOf(viewer, way))
  let [off, all] = [0, 0]
  for (const [i, value] of second!.entries()) {
    const alpha = i - (i % 4) + 3
    if (i === alpha || second![alpha] === 0) continue
    off += (value - first![i]!) ** 2
    all += value ** 2
  }
  return all === 0 ? null : Math.sqrt(off / all)
}

/** Radiance and coverage, four numbers a pixel. */
function radianceOf(viewer: Viewer, way: Way): Float32Array {
  const height = Math.max(Math.round(WIDTH / viewer.camera.aspect), 1)
  const target = new WebGLRenderTarget(WIDTH, height, { type: FloatType })
  try {
    drawRadiance(viewer, target, way)
    const pixels = new Float32Array(4 * WIDTH * height)
    viewer.renderer.readRenderTargetPixels(target, 0, 0, WIDTH, height, pixels)
    return pixels
  } finally {
    target.dispose()
  }
}
