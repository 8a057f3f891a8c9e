import { texelFromParameter } from '../maps/axes.ts'
import { arrayOf, valuesOf, type LoadedMap } from '../maps/load.ts'
import type { SpectralNode } from '../spectrum/spectral-nodes.ts'

/** Steps of w = cosθ_i + cosθ_o, from 0 to 2, at which a sample's colour is stored. */
export const W_STEPS = 33

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
 * @param relief - a map with the arrays `places` and `powers`; its first cell is order 0, which has the first sample
 * @param nodes - bands of the light's spectrum, seen in the metal
 * @param count - samples at most, 2 or more
 */
export function environmentSamples(
  relief: LoadedMap,
  nodes: readonly SpectralNode[],
  count: number,
): EnvironmentSample[] {
  const power = cellPowers(relief)
  const [mirror, scattered] = pointsOf(relief, nodes, power)
  const clusters = scattered.length > 0 ? [clusterOf(scattered)] : []
  while (clusters.length < count - 1) {
    const widest = indexOfWidest(clusters)
    if (widest === null) break
    clusters.splice(widest, 1, ...halves(clusters[widest]!).map(clusterOf))
  }
  return [clusterOf(mirror), ...clusters].map(({ points, x, y, spread }) => ({
    place: [x, y],
    deviation: Math.sqrt(spread / 2),
    colors: colorsOf(points, power),
  }))
}

/** Power of a cell at p = w/λ, linear between the map's samples. */
type CellPower = (cell: number, p: number) => number

function cellPowers(relief: LoadedMap): CellPower {
  const array = arrayOf(relief, 'powers')
  const axis = array.spec.axes[1]!
  const values = valuesOf(array)
  return (cell, p) => {
    const texel = Math.min(texelFromParameter(axis, p), axis.size - 1)
    const low = Math.min(Math.floor(texel), axis.size - 2)
    const at = cell * axis.size + low
    return values[at]! + (values[at + 1]! - values[at]!) * (texel - low)
  }
}

/** Order 0 in all bands, and every other cell in each. */
function pointsOf(
  relief: LoadedMap,
  nodes: readonly SpectralNode[],
  power: CellPower,
): [Point[], Point[]] {
  const array = arrayOf(relief, 'places')
  const [cells, channels] = array.spec.shape as [number, number]
  const values = valuesOf(array)
  const points = nodes.flatMap((node) => {
    const { wavelength, bandwidth, tints } = node
    const brightness = tints.reduce((sum, value) => sum + value, 0)
    return Array.from({ length: cells }, (_, cell): Point => {
      const [x, y, deviation] = values.subarray(cell * channels) as unknown as [
        number,
        number,
        number,
      ]
      return {
        x: wavelength * x,
        y: wavelength * y,
        // The band moves it along a stretch, of which 1/√12 is the deviation.
        spread: 2 * (wavelength * deviation) ** 2 + (bandwidth ** 2 * (x * x + y * y)) / 12,
        weight: brightness * meanPower(power, cell, wavelength),
        cell,
        node,
      }
    })
  })
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
