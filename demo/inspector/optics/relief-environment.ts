import type { Steps } from '../../../web/steps'
import type { LocalEnvironment } from './environment-light'
import { kirchhoffFactor } from './kirchhoff'
import { linePowers } from './line-powers'
import type { Direction } from './orders'
import type { ReliefOptics } from './relief'
import { TiltedEnvironment } from './tilted-environment'

/** Lines that take this share of the light are looked at in every nanometre. */
const STRONG = 3e-3
/** The widest band of wavelengths in which another line is looked at once, in nanometres. */
const WIDEST_BAND = 20
/** 1/cosθ_i is taken as it is in a band's middle where cosθ_i² is at least so many times the band's width in (x, y). */
const EVEN = 33

/**
 * Light of an environment that a relief sends to the viewer: an arc of it for each line (docs/theory/height-fields.md). Bands of
 * the fainter lines are wider; those of neighbours begin elsewhere.
 *
 * @param wo - ω_o, above the horizon
 * @param wavelengths - µm, by 1 nm
 * @param environment - in the patch's axes
 * @returns for each wavelength the environment's linear sRGB times what the lines take, three numbers
 */
export function* reliefUnderEnvironment(
  { relief, reflectance, roughness }: ReliefOptics,
  wo: Direction,
  wavelengths: readonly number[],
  environment: LocalEnvironment,
): Steps<Float64Array> {
  const tilted = new TiltedEnvironment(environment, wo, roughness, false)
  const powers = yield* linePowers(relief)
  const count = wavelengths.length
  const nanometre = wavelengths[1]! - wavelengths[0]!
  // What bands begin and end with; its running sum is what is seen.
  const changes = new Float64Array(3 * (count + 1))
  const light = new Float64Array(3)
  const wi: [number, number, number] = [0, 0, 0]
  for (let line = 0; line < powers.count; line++) {
    yield
    const [fx, fy] = [powers.fx[line]!, powers.fy[line]!]
    // cosθ_i² is a parabola over λ, A² − f² (λ − λ_0)². Order 0, f = 0, stays where it is.
    const f = Math.max(Math.hypot(fx, fy), 1e-9)
    const middle = (fx * wo[0] + fy * wo[1]) / f ** 2
    const a = Math.sqrt(wo[2] ** 2 + (f * middle) ** 2)
    const [shortest, longest] = [middle - a / f, middle + a / f]
    const band = Math.min(
      Math.max(Math.floor(Math.sqrt(STRONG / powers.largest[line]!)), 1),
      WIDEST_BAND,
    )
    for (let end = 1 + (line % band), start = 0; start < count; start = end, end += band) {
      const stop = Math.min(end, count)
      const low = wavelengths[start]! - nanometre / 2
      const high = wavelengths[stop - 1]! + nanometre / 2
      const from = Math.max(low, shortest)
      const to = Math.min(high, longest)
      if (from >= to) continue
      const wavelength = (from + to) / 2
      wi[0] = wavelength * fx - wo[0]
      wi[1] = wavelength * fy - wo[1]
      wi[2] = Math.sqrt(Math.max(1 - wi[0] ** 2 - wi[1] ** 2, 0))
      const width = f * (high - low)
      // cosθ_i times the mean of 1/cosθ_i over the band: that has no bound at the horizon, but its integral is an arcsine.
      const raised =
        wi[2] ** 2 > EVEN * width
          ? 1
          : (wi[2] * (turn((f * (to - middle)) / a) - turn((f * (from - middle)) / a))) / width
      const share =
        raised *
        powers.at(line, (wi[2] + wo[2]) / wavelength) *
        reflectance(wavelength, wi, wo) *
        kirchhoffFactor(wi, wo)
      light.fill(0)
      tilted.add(wi[0], wi[1], share, light, 0)
      for (let c = 0; c < 3; c++) {
        changes[3 * start + c]! += light[c]!
        changes[3 * stop + c]! -= light[c]!
      }
    }
  }
  for (let i = 3; i < changes.length; i++) changes[i]! += changes[i - 3]!
  return changes.subarray(0, 3 * count)
}

function turn(sine: number): number {
  return Math.asin(Math.min(Math.max(sine, -1), 1))
}
