import { FloatType, WebGLRenderTarget } from 'three'
import { drawRefinementFrame } from '../../web/refinement/refinement-frame'
import { bitByBit, type Steps } from '../../web/steps'
import type { Viewer } from '../view/viewer'
import { drawRadiance, type Way } from './draw-radiance'
import { pickPlaces, type Place } from './places'
import { radiancePicture } from './radiance-picture'

/**
 * What is drawn of a place is a pixel as much finer than the view's, along each side: it covers one texel of a foil and has
 * one radiance, for how a mean over texels or curves is made is another question.
 */
const FINER = 64

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
  // Only what shows an environment differs from frame to frame: the picture at rest is the mean of all.
  const frames = viewer.scene.environment === null ? 1 : viewer.frames
  const targets = ways.map(() => new WebGLRenderTarget(count, frames, { type: FloatType }))
  try {
    await bitByBit(drawn())
    if (isStale()) return null
    const colours = await Promise.all(
      targets.map((target) =>
        viewer.renderer.readRenderTargetPixelsAsync(
          target,
          ...([0, 0, count, frames] as const),
          new Float32Array(4 * count * frames),
        ),
      ),
    )
    return places.map((place, i) => ({
      ...place,
      colours: colours.map((pixels) =>
        [0, 1, 2].map((channel) => mean(pixels as Float32Array, 4 * i + channel)),
      ),
    }))
  } finally {
    for (const target of targets) target.dispose()
  }

  function* drawn(): Steps<void> {
    const { width, height } = viewer.renderer.domElement
    const [columns, rows] = [FINER * width, FINER * height]
    for (const [k, way] of ways.entries())
      for (let index = 0; index < frames; index++)
        for (const [i, { x, y }] of places.entries()) {
          if (isStale()) return
          const target = targets[k]!
          target.viewport.set(i, index, 1, 1)
          target.scissor.set(i, index, 1, 1)
          target.scissorTest = true
          // The pixel's middle is the place.
          const [left, top] = [((1 + x) / 2) * columns - 0.5, ((1 - y) / 2) * rows - 0.5]
          viewer.camera.setViewOffset(columns, rows, left, top, 1, 1)
          try {
            drawRefinementFrame(viewer.scene, { index, count: viewer.frames }, () => {
              drawRadiance(viewer, target, way)
            })
          } finally {
            viewer.camera.clearViewOffset()
          }
          yield
        }
  }

  function mean(pixels: Float32Array, at: number): number {
    let sum = 0
    for (let i = at; i < pixels.length; i += 4 * count) sum += pixels[i]!
    return sum / frames
  }
}
