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
import { viewSamples, type Sample } from './view-strips'

/** Places of the view at which the spectrum is summed up; with fewer than the least nothing is said. */
const PLACES = 160
const LEAST_PLACES = 24

/**
 * Relative root mean square error of the linear radiance that each way draws of the object, as it is seen now: at places
 * of the view, against the sum over wavelengths in float64. Bright places are looked at more often, and count less each.
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
  return bitByBit(
    errorsOf(samples, ({ x, y }) => referenceAt(demo, tables, new Vector2(x, y)), isStale),
  )
}

/**
 * Relative root mean square error of each way's colours over samples that are even over the view, from some of them.
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
  for (const { sample, share } of chosen(samples)) {
    if (isStale()) return null
    const truth = yield* reference(sample)
    yield
    if (truth === null) continue
    places++
    truth.forEach((value, channel) => {
      all += value ** 2 / share
      sample.colours.forEach((colour, way) => {
        off[way]! += (colour[channel]! - value) ** 2 / share
      })
    })
  }
  return places < LEAST_PLACES || all === 0 ? null : off.map((sum) => Math.sqrt(sum / all))
}

/**
 * Samples picked with a probability that is half even and half proportional to the square of radiance, as what is summed up
 * is, at even steps of its sum.
 *
 * @returns with each its probability, in any unit
 */
function chosen(samples: readonly Sample[]): { sample: Sample; share: number }[] {
  const squares = samples.map(({ colours }) =>
    colours.flat().reduce((sum, value) => sum + value ** 2, 0),
  )
  const whole = squares.reduce((sum, value) => sum + value, 0)
  if (whole === 0) return []
  const shares = squares.map((value) => 0.5 / samples.length + (0.5 * value) / whole)
  const picked: { sample: Sample; share: number }[] = []
  let sum = 0
  for (const [i, share] of shares.entries()) {
    sum += share
    while (picked.length < PLACES && (picked.length + 0.5) / PLACES < sum)
      picked.push({ sample: samples[i]!, share })
  }
  return picked
}

/** What the object sends to the eye from a place of the view, linear sRGB within the gamut; null where it is not seen. */
function* referenceAt(demo: Demo, tables: SpectralTables, place: Vector2): Steps<Colour | null> {
  const { subject, viewer } = demo
  const point = pickAt(place, viewer.camera, subject.object, subject.material)
  if (point === null) return null
  const optics = opticsAt(demo, tables, point)
  const light = environmentLight(demo)
  const { colour } = flashRadiance(optics)
  if (light !== null)
    (yield* environmentRadiance(optics, light)).colour.forEach((value, c) => (colour[c]! += value))
  return gamutMapped(colour)
}
