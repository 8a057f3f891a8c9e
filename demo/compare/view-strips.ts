import { FloatType, WebGLRenderTarget } from 'three'
import { bitByBit, type Steps } from '../../web/steps'
import type { Viewer } from '../view/viewer'
import { drawRadiance, type Way } from './draw-radiance'

/** How many strips of the view are drawn, a pixel high, and how many pixels wide each is. */
const STRIPS = 64
const WIDTH = 512
/**
 * Their pixels are as much finer than the view's, along each side: what a pixel covers has nearly one radiance, that of its
 * middle, for how a mean over texels or curves is made is another question.
 */
const FINER = 4

/** What is drawn of one place of the view. */
export interface Sample {
  /** Across and up, −1 to 1. */
  x: number
  y: number
  /** Linear sRGB by each way. */
  colours: readonly (readonly number[])[]
}

/** Where a strip lies: from the left and the top, in fine pixels. */
interface Strip {
  left: number
  top: number
}

/**
 * Draws strips that lie evenly over the view.
 *
 * @param isStale - whether the picture has changed since
 * @returns what the object covers of them, strip by strip; null where the picture has changed or the device draws in no
 * floats
 */
export async function viewSamples(
  viewer: Viewer,
  ways: readonly Way[],
  isStale: () => boolean,
): Promise<Sample[] | null> {
  if (!viewer.renderer.extensions.has('EXT_color_buffer_float')) return null
  const { width, height } = viewer.renderer.domElement
  const whole = { width: FINER * width, height: FINER * height }
  const strips = evenStrips(whole)
  const targets = ways.map(() => new WebGLRenderTarget(WIDTH, STRIPS, { type: FloatType }))
  try {
    const isDrawn = await bitByBit(drawn())
    if (!isDrawn) return null
    const pictures = await Promise.all(
      targets.map((target) =>
        viewer.renderer.readRenderTargetPixelsAsync(
          target,
          ...([0, 0, WIDTH, STRIPS] as const),
          new Float32Array(4 * WIDTH * STRIPS),
        ),
      ),
    )
    return isStale() ? null : covered(pictures as Float32Array[])
  } finally {
    for (const target of targets) target.dispose()
  }

  function* drawn(): Steps<boolean> {
    for (const [row, { left, top }] of strips.entries())
      for (const [i, way] of ways.entries()) {
        if (isStale()) return false
        const target = targets[i]!
        target.viewport.set(0, row, WIDTH, 1)
        target.scissor.set(0, row, WIDTH, 1)
        target.scissorTest = true
        viewer.camera.setViewOffset(whole.width, whole.height, left, top, WIDTH, 1)
        drawRadiance(viewer, target, way)
        viewer.camera.clearViewOffset()
        yield
      }
    return !isStale()
  }

  function covered(pictures: readonly Float32Array[]): Sample[] {
    return strips.flatMap(({ left, top }, row) =>
      Array.from({ length: WIDTH }, (_, column) => 4 * (row * WIDTH + column)).flatMap(
        (at, column) =>
          pictures[0]![at + 3] === 0
            ? []
            : [
                {
                  x: (2 * (left + column + 0.5)) / whole.width - 1,
                  y: 1 - (2 * (top + 0.5)) / whole.height,
                  colours: pictures.map((picture) => Array.from(picture.subarray(at, at + 3))),
                },
              ],
      ),
    )
  }
}

/** Fractions of the powers of the plastic number: places that fill a square evenly, however many there are (Roberts 2018). */
const EVEN = [0.7548776662466927, 0.5698402909980532] as const

function evenStrips({ width, height }: { width: number; height: number }): Strip[] {
  return Array.from({ length: STRIPS }, (_, i) => ({
    left: Math.floor(((0.5 + i * EVEN[0]) % 1) * Math.max(width - WIDTH, 0)),
    top: Math.floor(((0.5 + i * EVEN[1]) % 1) * height),
  }))
}
