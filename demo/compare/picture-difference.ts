import type { Viewer } from '../view/viewer'
import type { Way } from './draw-radiance'
import { radiancePicture } from './radiance-picture'

/**
 * Relative root mean square difference of linear radiance between two ways to draw the scene, one frame each: that of
 * the second from the first, over the root mean square of the second, over all pixels that the object covers. null
 * where the device draws in no floats or nothing is covered.
 */
export function pictureDifference(viewer: Viewer, ways: readonly [Way, Way]): number | null {
  const [first, second] = ways.map((way) => radiancePicture(viewer, way)?.pixels)
  if (!first || !second) return null
  let [off, all] = [0, 0]
  for (const [i, value] of second.entries()) {
    const alpha = i - (i % 4) + 3
    if (i === alpha || second[alpha] === 0) continue
    off += (value - first[i]!) ** 2
    all += value ** 2
  }
  return all === 0 ? null : Math.sqrt(off / all)
}
