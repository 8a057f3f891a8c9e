import { describe, expect, it } from 'vitest'
import {
  environmentSamples as samplesInSteps,
  type EnvironmentSample,
} from '../../web/height-field/environment-samples'
import { W_STEPS } from '../../web/height-field/lookups'
import { reliefSpectrum } from '../../web/height-field/relief-spectrum'
import type { LoadedMap } from '../../web/maps/load'
import type { SpectralNode } from '../../web/spectrum/spectral-nodes'
import { atOnce } from '../../web/steps'

function environmentSamples(
  relief: LoadedMap,
  nodes: readonly SpectralNode[],
  count: number,
): EnvironmentSample[] {
  return atOnce(samplesInSteps(reliefSpectrum(relief), nodes, count))
}

/** (f_x, f_y, deviation) and the power of a cell; the first is order 0. */
type Cell = [number, number, number, number]

/** Cells of a spectrum whose powers do not depend on w/λ. */
function reliefOf(cells: Cell[]): LoadedMap {
  const phases = { name: 'w/lambda', symbol: 'p', unit: '1/um', size: 3, first: 0, last: 6 }
  const arrays = {
    places: {
      spec: { shape: [cells.length, 4], axes: [] },
      data: Float32Array.from(cells.flatMap(([x, y, deviation]) => [x, y, deviation, 0])),
    },
    powers: {
      spec: { shape: [cells.length, 3, 1], axes: [null, { ...phases, mapping: 'linear' }] },
      data: Float32Array.from(cells.flatMap(([, , , power]) => [power, power, power])),
    },
  }
  return { arrays } as unknown as LoadedMap
}

function nodesOf(count: number): SpectralNode[] {
  const bandwidth = 0.4 / count
  return Array.from({ length: count }, (_, i) => ({
    wavelength: 0.38 + (i + 0.5) * bandwidth,
    bandwidth,
    tints: Array.from({ length: 9 }, (_, c) => (1 + ((i + c) % 4)) / count),
  }))
}

const sum = (values: Iterable<number>): number => [...values].reduce((a, b) => a + b, 0)
/** What a sample counts for: the sum of its colours, at one of the steps of w. */
const weightOf = ({ colors }: { colors: Float32Array }): number => sum(colors.subarray(0, 9))

const SCATTERED: Cell[] = Array.from({ length: 40 }, (_, i) => [
  1.5 * Math.cos(i) * Math.sqrt(i / 40),
  1.5 * Math.sin(i) * Math.sqrt(i / 40),
  0.02 + 0.001 * i,
  (1 + (i % 5)) / 100,
])
const CELLS: Cell[] = [[0, 0, 0, 0.4], ...SCATTERED]

describe('samples of an environment', () => {
  it('are as many as asked for, order 0 first and sharp', () => {
    const samples = environmentSamples(reliefOf(CELLS), nodesOf(8), 50)
    expect(samples).toHaveLength(50)
    expect(samples[0]).toMatchObject({ place: [0, 0], deviation: 0 })
  })

  it('are the cells in each band, where there are no more', () => {
    const samples = environmentSamples(reliefOf(CELLS), nodesOf(3), 1000)
    expect(samples).toHaveLength(1 + 3 * 40)
  })

  it('share out all the light in each colour, at each step of w', () => {
    const nodes = nodesOf(8)
    const samples = environmentSamples(reliefOf(CELLS), nodes, 30)
    const power = sum(CELLS.map(([, , , p]) => p))
    for (const step of [0, 7, W_STEPS - 1])
      for (let c = 0; c < 9; c++) {
        const expected = power * sum(nodes.map(({ tints }) => tints[c]!))
        expect(sum(samples.map(({ colors }) => colors[9 * step + c]!))).toBeCloseTo(expected, 5)
      }
  })

  it('keep the middle of the light and how far it spreads', () => {
    const nodes = nodesOf(8)
    const samples = environmentSamples(reliefOf(CELLS), nodes, 30)
    const total = sum(samples.map(weightOf))
    let [x, square] = [0, 0]
    for (const { wavelength, bandwidth, tints } of nodes)
      for (const [fx, fy, deviation, power] of CELLS) {
        const share = (power * sum(tints)) / total
        const f2 = fx ** 2 + fy ** 2
        x += share * wavelength * fx
        // A band's places are even along a stretch: its variance is a twelfth of the square of the length.
        square += share * (wavelength ** 2 * (f2 + 2 * deviation ** 2) + (bandwidth ** 2 * f2) / 12)
      }
    const mean = (of: (sample: (typeof samples)[number]) => number): number =>
      sum(samples.map((sample) => (weightOf(sample) / total) * of(sample)))
    expect(mean(({ place }) => place[0])).toBeCloseTo(x, 6)
    const squares = mean(({ place, deviation }) => Math.hypot(...place) ** 2 + 2 * deviation ** 2)
    expect(squares).toBeCloseTo(square, 6)
  })

  it('put a single line where its wavelengths go', () => {
    const [, ...samples] = environmentSamples(
      reliefOf([
        [0, 0, 0, 0.5],
        [0.6, 0.8, 0, 0.5],
      ]),
      nodesOf(4),
      100,
    )
    const lengths = samples.map(({ place }) => Math.hypot(...place)).sort()
    lengths.forEach((length, i) => {
      expect(length).toBeCloseTo(0.43 + 0.1 * i, 6) // |f| = 1
    })
    for (const { place, deviation } of samples) {
      expect(place[1] / place[0]).toBeCloseTo(8 / 6, 6)
      expect(deviation).toBeCloseTo(0.1 / Math.sqrt(24), 6)
    }
  })

  it('are order 0 alone where nothing is scattered', () => {
    const samples = environmentSamples(reliefOf([[0, 0, 0, 1]]), nodesOf(4), 100)
    expect(samples).toHaveLength(1)
  })

  it('leave out what is below the horizon from wherever one looks', () => {
    const relief = reliefOf([
      [0, 0, 0, 0.5],
      [1, 0, 0, 0.25],
      [6, 0, 0, 0.25],
    ])
    // 6 · 0.38 is above 2 already.
    expect(environmentSamples(relief, nodesOf(4), 100)).toHaveLength(1 + 4)
  })
})
