import { DataTexture, DataUtils, HalfFloatType, RGBAFormat, Vector2, type IUniform } from 'three'
import { floatLiteral } from '../glsl/float-literal.ts'
import { unfiltered } from '../maps/shared-texture.ts'

/** Number of patches along x and y. */
export type Tiles = readonly [number, number]

/**
 * Share of its peak below which a line's amplitude is left out, but for order 0. With 0.005 pictures of two to ten repeats
 * were within 1 % of all lines', with 0.01 some were 2 % off.
 */
const TAIL = 0.005

/** Deviations of a Gaussian beyond which it counts as dark. */
const CORE = 5.5

/** Of the lobes over |f|: thirty between two zeros where tails are longest. */
const SAMPLES = 2048

/** Of the lobes over the window's share of their deviation. */
const SHARES = 32

/** Steps over half the window: eight a wave at the table's end. */
const STEPS = 256

/**
 * One axis of the coherence window exp(−x²/2σ²), cut to |x| ≤ length/2. Its transform L is real and even
 * (docs/theory/height-fields.md). Frequencies are counted in the deviation of the Gaussian that has the energy and the peak
 * of L².
 */
class CutWindow {
  /** Of that Gaussian, 1/µm. */
  readonly deviation: number
  /** Beyond which |L| is less than TAIL of its peak, in deviations. */
  readonly reach: number
  readonly #half: number
  readonly #weights: Float64Array

  /** coherence: σ; length: N times the period, both µm. */
  constructor(coherence: number, length: number) {
    // Beyond 8σ is nothing that a sum would miss.
    const half = Math.min(length / 2, 8 * coherence)
    const weights = new Float64Array(STEPS + 1)
    let peak = 0
    let area = 0
    for (let i = 0; i <= STEPS; i++) {
      const x = (i / STEPS) * half
      const g = Math.exp(-0.5 * (x / coherence) ** 2)
      // Simpson's rule, for both halves.
      const weight = ((i % STEPS === 0 ? 2 : 4 + 4 * (i % 2)) * half) / (3 * STEPS)
      weights[i] = weight * g
      peak += weight * g
      area += weight * g * g
    }
    this.#weights = weights.map((weight) => weight / peak)
    this.#half = half
    this.deviation = area / (Math.sqrt(2 * Math.PI) * peak ** 2)
    // |L| ends as g(length/2)/(πf).
    const edge = Math.exp(-0.5 * (length / 2 / coherence) ** 2)
    this.reach = Math.max(CORE, edge / (Math.PI * this.deviation * peak * TAIL))
  }

  /** L over its peak, from 0 on in steps of so many deviations. */
  amplitudes(step: number): Float64Array {
    return Float64Array.from({ length: SAMPLES }, (_, k) => {
      const twice = 2 * Math.cos((2 * Math.PI * this.#half * this.deviation * step * k) / STEPS)
      // cos(nθ) = 2 cosθ cos((n − 1)θ) − cos((n − 2)θ)
      let before = twice / 2
      let cosine = 1
      let sum = 0
      for (const weight of this.#weights) {
        sum += weight * cosine
        const next = twice * cosine - before
        before = cosine
        cosine = next
      }
      return sum
    })
  }
}

/**
 * The root of L² blurred by a Gaussian, over the peak of a Gaussian as wide as both.
 *
 * @param amplitudes - L over its peak, in steps of so many deviations
 * @param step - also that of the result, in deviations of the blurred lobe
 * @param share - the window's of the deviation, 0 to 1
 */
function blurred(amplitudes: Float64Array, step: number, share: number): Float64Array {
  if (share === 0) return amplitudes.map((_, k) => Math.exp(-0.25 * (k * step) ** 2))
  if (share === 1) return amplitudes.map(Math.abs)
  const width = Math.sqrt(1 / share ** 2 - 1) / step // of the Gaussian, in steps
  // L² has no wave shorter than 2.5 deviations: sums are integrals with fewer samples too.
  const stride = Math.max(1, Math.floor(Math.min(0.6 / step, 0.8 * width)))
  let energy = 0
  amplitudes.forEach((a, k) => (energy += (k === 0 ? 1 : 2) * a * a))
  return amplitudes.map((_, i) => {
    const middle = i / share
    const first = Math.max(middle - CORE * width, 1 - SAMPLES)
    const last = Math.min(middle + CORE * width, SAMPLES - 1)
    let sum = 0
    for (let k = stride * Math.ceil(first / stride); k <= last; k += stride)
      sum += amplitudes[Math.abs(k)]! ** 2 * Math.exp(-0.5 * ((middle - k) / width) ** 2)
    return Math.sqrt((sum * stride) / (energy * share * width * step))
  })
}

/** What a cut window adds to the program. */
interface WindowOptics {
  defines: Record<string, string | number>
  uniforms: Record<string, IUniform>
}

/** The last window of each surface, known by its tiles: it stays where other settings change. */
const windows = new WeakMap<Tiles, { key: string; window: WindowOptics }>()

/**
 * Defines and uniforms of the part of shaders/line-spectrum.glsl that a cut window needs.
 *
 * @param period - of the patch along x and y, µm
 * @param coherence - σ, µm
 */
export function cutWindow(
  tiles: Tiles,
  period: readonly [number, number],
  coherence: number,
): WindowOptics {
  const key = [...period, coherence].join()
  const last = windows.get(tiles)
  if (last?.key === key) return last.window
  const x = new CutWindow(coherence, tiles[0] * period[0])
  const y = new CutWindow(coherence, tiles[1] * period[1])
  const reach = Math.max(x.reach, y.reach)
  const window = {
    defines: {
      TILES: '',
      CUT_CORE: floatLiteral(CORE),
      CUT_REACH: floatLiteral(reach),
      CUT_SAMPLES: SAMPLES,
      CUT_SHARES: SHARES,
      CUT_TAIL: floatLiteral(TAIL),
    },
    uniforms: {
      uTiles: { value: new Vector2(...tiles) },
      uCutVariance: { value: new Vector2(x.deviation ** 2, y.deviation ** 2) },
      uCutLobes: { value: lobesTexture(x, y, reach / (SAMPLES - 1)) },
    },
  }
  windows.set(tiles, { key, window })
  return window
}

/** A row for each share of the window, then the sharp lobes; a texel holds those along x and y, each with its step. */
function lobesTexture(x: CutWindow, y: CutWindow, step: number): DataTexture {
  const texels = new Uint16Array(4 * SAMPLES * (SHARES + 1))
  for (const [axis, window] of [x, y].entries()) {
    const sharp = window.amplitudes(step)
    for (let row = 0; row <= SHARES; row++) {
      const lobe = row === SHARES ? sharp : blurred(sharp, step, row / (SHARES - 1))
      lobe.forEach((value, k) => {
        const texel = 4 * (row * SAMPLES + k) + 2 * axis
        texels[texel] = DataUtils.toHalfFloat(value)
        texels[texel + 1] = DataUtils.toHalfFloat((lobe[k + 1] ?? value) - value)
      })
    }
  }
  return unfiltered(new DataTexture(texels, SAMPLES, SHARES + 1, RGBAFormat, HalfFloatType))
}
