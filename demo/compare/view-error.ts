import { Vector2 } from 'three'
import { bitByBit, type Steps } from '../../web/steps'
import type { Demo } from '../demo'
import { gamutMapped } from '../inspector/optics/display'
import type { Colour } from '../inspector/optics/light-spectrum'
import { pickAt } from '../inspector/picked-point'
import { loadTables, type SpectralTables } from '../inspector/point-optics'
import { environmentRadiance, flashRadiance } from '../inspector/radiance'
import { environmentLight, opticsAt } from '../inspector/scene-light'
import type { Way } from './draw-radiance'
import { viewSamples, type Sample } from './view-samples'

/** With fewer places nothing is said. */
const LEAST_PLACES = 24
/** After that long no more than these are looked at, ms: a spectrum of some reliefs takes half a second. */
const LONG = 4000

/**
 * Relative root mean square error of the linear radiance that each way draws of the object, as it is seen now: at places
 * of the view, against the sum over wavelengths in float64.
 *
 * @param isStale - whether the picture has changed since
 * @returns null where it has, where the object is hardly seen or dark, or the device draws in no floats
 */
export async function viewErrors(
  demo: Demo,
  ways: readonly Way[],
  isStale: () => boolean,
): Promise<readonly number[] | null> {
  const tables = await loadTables(demo.subject)
  if (isStale()) return null
  const samples = await viewSamples(demo.viewer, ways, isStale)
  if (samples === null) return null
  return bitByBit(errorsOf(samples, (sample) => referenceAt(demo, tables, sample), isStale))
}

/**
 * Relative root mean square error of each way's colours over a view, from samples of it: what is picked more often counts
 * less.
 *
 * @param reference - linear sRGB that a sample should have; null where it does not count
 */
export function* errorsOf(
  samples: readonly Sample[],
  reference: (sample: Sample) => Steps<Colour | null>,
  isStale: () => boolean,
): Steps<readonly number[] | null> {
  const off = samples[0]?.colours.map(() => 0) ?? []
  let [all, places] = [0, 0]
  const end = performance.now() + LONG
  for (const sample of samples) {
    if (isStale()) return null
    if (places >= LEAST_PLACES && performance.now() > end) break
    const truth = yield* reference(sample)
    yield
    if (truth === null) continue
    places++
    truth.forEach((value, channel) => {
      all += value ** 2 / sample.share
      sample.colours.forEach((colour, way) => {
        off[way]! += (colour[channel]! - value) ** 2 / sample.share
      })
    })
  }
  return places < LEAST_PLACES || all === 0 ? null : off.map((sum) => Math.sqrt(sum / all))
}

/** What the object sends to the eye from a place of the view, linear sRGB within the gamut; null where it is not seen. */
function* referenceAt(demo: Demo, tables: SpectralTables, { x, y }: Sample): Steps<Colour | null> {
  const { subject, viewer } = demo
  const point = pickAt(new Vector2(x, y), viewer.camera, subject.object, subject.material)
  if (point === null) return null
  const optics = opticsAt(demo, tables, point)
  const light = environmentLight(demo)
  const { colour } = flashRadiance(optics)
  if (light !== null)
    (yield* environmentRadiance(optics, light)).colour.forEach((value, c) => (colour[c]! += value))
  return gamutMapped(colour)
}
