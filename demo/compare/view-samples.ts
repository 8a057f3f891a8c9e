import { FloatType, WebGLRenderTarget } from 'three'
import { bitByBit, type Steps } from '../../web/steps'
import type { Viewer } from '../view/viewer'
import { drawRadiance, type Way } from './draw-radiance'
import { pickPlaces, type Place } from './places'
import { radiancePicture } from './radiance-picture'

/**
 * What is drawn of a place is a pixel as much finer than the view's, along each side: it covers one texel of a foil and has
 * one radiance, for how a mean over texels or curves is made is another question.
 */
const FINER = 16

/** What is drawn of one place of the view. */
export interface Sample extends Place {
  /** Linear sRGB by each way. */
  colours: readonly (readonly number[])[]
}

/**
 * Draws single places of the view that the object covers, each by itself.
 *
 * @param isStale - whether the picture has changed since
 * @returns null where it has, or where the device draws in no floats
 */
export async function viewSamples(
  viewer: Viewer,
  ways: readonly Way[],
  isStale: () => boolean,
): Promise<Sample[] | null> {
  const pictures = ways.flatMap((way) => radiancePicture(viewer, way) ?? [])
  if (pictures.length === 0) return null
  const places = pickPlaces(pictures)
  const count = places.length
  if (count === 0) return []
  const targets = ways.map(() => new WebGLRenderTarget(count, 1, { type: FloatType }))
  try {
    await bitByBit(drawn())
    if (isStale()) return null
    const colours = await Promise.all(
      targets.map((target) =>
        viewer.renderer.readRenderTargetPixelsAsync(
          target,
          ...([0, 0, count, 1] as const),
          new Float32Array(4 * count),
        ),
      ),
    )
    return places.map((place, i) => ({
      ...place,
      colours: colours.map((pixels) => Array.from(pixels.subarray(4 * i, 4 * i + 3))),
    }))
  } finally {
    for (const target of targets) target.dispose()
  }

  function* drawn(): Steps<void> {
    const { width, height } = viewer.renderer.domElement
    const [columns, rows] = [FINER * width, FINER * height]
    for (const [i, { x, y }] of places.entries())
      for (const [k, way] of ways.entries()) {
        if (isStale()) return
        const target = targets[k]!
        target.viewport.set(i, 0, 1, 1)
        target.scissor.set(i, 0, 1, 1)
        target.scissorTest = true
        // The pixel's middle is the place.
        const [left, top] = [((1 + x) / 2) * columns - 0.5, ((1 - y) / 2) * rows - 0.5]
        viewer.camera.setViewOffset(columns, rows, left, top, 1, 1)
        drawRadiance(viewer, target, way)
        viewer.camera.clearViewOffset()
        yield
      }
  }
}
