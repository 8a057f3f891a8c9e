import type { SpectralNode } from '../spectrum/spectral-nodes.ts'
import type { Steps } from '../steps.ts'
import { W_STEPS } from './lookups.ts'
import type { CellPower, ReliefSpectrum } from './relief-spectrum.ts'

/**
 * Light is lit and seen at less than grazing angles where most of it is seen: samples are shared out by what lines take
 * on average over w from this step, 1, to 2.
 */
const FIRST_TYPICAL = (W_STEPS - 1) / 2

/** What one lookup of the environment stands for: lines of a relief's spectrum at some wavelengths. */
export interface EnvironmentSample {
  /** Where they send the light, λf, in the plane of the surface: from −(ω_o)_xy to (ω_i)_xy. */
  place: [number, number]
  /** Root mean square distance of their light from there along one axis. */
  deviation: number
  /** XYZ in light of the three tint bases, red's, green's, blue's, at each step of w; nine numbers a step. */
  colors: Float32Array
}

/** A cell of the spectrum in a band of wavelengths. */
interface Point {
  x: number
  y: number
  /** Mean square distance of its own light from there, along both axes together. */
  spread: number
  weight: number
  cell: number
  node: SpectralNode
}

/** Points, with their moments. */
interface Cluster {
  points: Point[]
  weight: number
  x: number
  y: number
  /** Covariance of the points' places. */
  xx: number
  yy: number
  xy: number
  /** Mean square distance of all light from the middle. */
  spread: number
}

/**
 * Divides the light that a relief sends about into samples, so that few lookups stand for all lines at all
 * wavelengths. A line at f sends light of the wavelength λ to λf: what matters is how it is spread there, whichever
 * line and wavelength it came from. Whichever sample has the largest weight times deviation is halved next,
 * across its longest axis.
 *
 * @param spectrum - its first cell is order 0, which has the first sample
 * @param nodes - bands of the light's spectrum, seen in the metal
 * @param count - samples at most, 2 or more
 */
export function* environmentSamples(
  spectrum: ReliefSpectrum,
  nodes: readonly SpectralNode[],
  count: number,
): Steps<EnvironmentSample[]> {
  const { power } = spectrum
  const [mirror, scattered] = yield* pointsOf(spectrum, nodes)
  const clusters = scattered.length > 0 ? [clusterOf(scattered)] : []
  while (clusters.length < count - 1) {
    const widest = indexOfWidest(clusters)
    if (widest === null) break
    clusters.splice(widest, 1, ...halves(clusters[widest]!).map(clusterOf))
    yield
  }
  const samples: EnvironmentSample[] = []
  for (const { points, x, y, spread } of [clusterOf(mirror), ...clusters]) {
    samples.push({
      place: [x, y],
      deviation: Math.sqrt(spread / 2),
      colors: colorsOf(points, power),
    })
    yield
  }
  return samples
}

/** Order 0 in all bands, and every other cell in each. */
function* pointsOf(
  { places, power }: ReliefSpectrum,
  nodes: readonly SpectralNode[],
): Steps<[Point[], Point[]]> {
  const points: Point[] = []
  for (const node of nodes) {
    yield
    const { wavelength, bandwidth, tints } = node
    const brightness = tints.reduce((sum, value) => sum + value, 0)
    for (const [cell, [x, y, deviation]] of places.entries()) {
      points.push({
        x: wavelength * x,
        y: wavelength * y,
        // The band moves it along a stretch, of which 1/√12 is the deviation.
        spread: 2 * (wavelength * deviation) ** 2 + (bandwidth ** 2 * (x * x + y * y)) / 12,
        weight: brightness * meanPower(power, cell, wavelength),
        cell,
        node,
      })
    }
  }
  return [
    points.filter(({ cell }) => cell === 0),
    // Places beyond 2 are below the horizon from wherever one looks.
    points.filter(
      ({ cell, weight, x, y, spread }) =>
        cell > 0 && weight > 0 && Math.hypot(x, y) < 2 + Math.sqrt(spread),
    ),
  ]
}

function meanPower(power: CellPower, cell: number, wavelength: number): number {
  let sum = 0
  for (let step = FIRST_TYPICAL; step < W_STEPS; step++)
    sum += power(cell, wOfStep(step) / wavelength)
  return sum / (W_STEPS - FIRST_TYPICAL)
}

function wOfStep(step: number): number {
  return (2 * step) / (W_STEPS - 1)
}

function clusterOf(points: Point[]): Cluster {
  let weight = 0
  let x = 0
  let y = 0
  for (const point of points) {
    weight += point.weight
    x += point.weight * point.x
    y += point.weight * point.y
  }
  x /= weight
  y /= weight
  let xx = 0
  let yy = 0
  let xy = 0
  let own = 0
  for (const point of points) {
    const share = point.weight / weight
    xx += share * (point.x - x) ** 2
    yy += share * (point.y - y) ** 2
    xy += share * (point.x - x) * (point.y - y)
    own += share * point.spread
  }
  return { points, weight, x, y, xx, yy, xy, spread: own + xx + yy }
}

/** The cluster of the largest weight times deviation, of those that can be halved; null where none can. */
function indexOfWidest(clusters: readonly Cluster[]): number | null {
  let widest: number | null = null
  let most = 0
  clusters.forEach(({ points, weight, spread }, i) => {
    const scatter = weight * weight * spread
    if (points.length < 2 || scatter <= most) return
    widest = i
    most = scatter
  })
  return widest
}

/** Cut across the longest axis, where half of the weight lies on either hand. */
function halves({ points, weight, x, y, xx, yy, xy }: Cluster): [Point[], Point[]] {
  const angle = Math.atan2(2 * xy, xx - yy) / 2
  const cos = Math.cos(angle)
  const sin = Math.sin(angle)
  const along = (point: Point): number => (point.x - x) * cos + (point.y - y) * sin
  const sorted = points
    .map((point) => ({ point, at: along(point) }))
    .sort((a, b) => a.at - b.at)
    .map(({ point }) => point)
  let passed = sorted[0]!.weight
  let first = 1
  while (first < sorted.length - 1 && passed < weight / 2) passed += sorted[first++]!.weight
  return [sorted.slice(0, first), sorted.slice(first)]
}

function colorsOf(points: readonly Point[], power: CellPower): Float32Array {
  const colors = new Float32Array(9 * W_STEPS)
  for (const { cell, node } of points)
    for (let step = 0; step < W_STEPS; step++) {
      const p = power(cell, wOfStep(step) / node.wavelength)
      for (let c = 0; c < 9; c++) colors[9 * step + c]! += p * node.tints[c]!
    }
  return colors
}
