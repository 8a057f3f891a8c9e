import { DataUtils, LinearMipmapNearestFilter, Vector2, type DataArrayTexture } from 'three'
import type { Steps } from '../steps.ts'
import type { FoilGratings } from './foil-gratings.ts'
import { averagedLayers } from './averaged-layers.ts'

/** Gratings among which the centres of clusters are found. */
const MOST_SAMPLES = 4096
const ITERATIONS = 12
/** Deviation of a cluster's weights over the distance between neighbours: with less a row of Gaussians ripples. */
const OVERLAP = 0.5
/** A grating's smaller parts are left to its other clusters. */
const SMALLEST_WEIGHT = 0.02

/** Gratings that are looked at before work may be left. */
const AT_ONCE = 512

/** Gratings that are much alike, in clusters that overlap. */
export interface FoilClusters {
  count: number
  /**
   * Layer l, at each cell of the map: the share of cluster l; this times the means of its gratings' turn and change, how far
   * they are off its centre in orientation and in frequency, in units of `reach`, and of the sum of their squares. The next
   * layer: the share of the cell that diffracts. The last, row by row from its first texel: cos θ, sin θ and frequency (1/µm)
   * of each cluster's centre, and which part of the sum of squares turn has in all of the foil.
   */
  texture: DataArrayTexture
  /** The furthest that a grating is off, rad and 1/µm. */
  reach: Vector2
}

/** A grating's part in a cluster, and how far it is off the cluster's centre. */
interface Part {
  cluster: number
  weight: number
  turn: number
  change: number
}

type Point = readonly [number, number]

/**
 * So many clusters for a foil of more gratings than that. In a pixel a cluster shows those of its gratings that the pixel has
 * as one Gaussian with their mean and variance: exact for a single one, and even for an even spread, since neighbours
 * overlap.
 *
 * @param count - clusters
 * @param mostCells - along the longer side of the map
 */
export function* foilClusters(
  foil: FoilGratings,
  count: number,
  mostCells: number,
): Steps<FoilClusters> {
  const points = foil.θ.map((θ, i): Point => {
    // Alike where orientations are, which are known modulo π.
    const frequency = foil.frequency[i]!
    return [frequency * Math.cos(2 * θ), frequency * Math.sin(2 * θ)]
  })
  const centres = yield* clusterCentres(points, count)
  const deviation = OVERLAP * typicalGap(centres)
  const clusters = centres.map(([x, y]) => ({
    θ: Math.atan2(y, x) / 2,
    frequency: Math.hypot(x, y),
  }))
  const parts: Part[][] = []
  // Not 0, by which the moments are divided.
  const reach = new Vector2(1e-6, 1e-6)
  for (const [i, point] of points.entries()) {
    if (i % AT_ONCE === 0) yield
    const ofPoint = weights(point, centres, deviation).map(([cluster, weight]): Part => {
      const { θ, frequency } = clusters[cluster]!
      const turn = foil.θ[i]! - θ
      return {
        cluster,
        weight,
        turn: turn - Math.PI * Math.round(turn / Math.PI),
        change: foil.frequency[i]! - frequency,
      }
    })
    parts.push(ofPoint)
    for (const { turn, change } of ofPoint)
      reach.set(Math.max(reach.x, Math.abs(turn)), Math.max(reach.y, Math.abs(change)))
  }
  const squares = clusters.map(() => ({ turn: 0, change: 0 }))
  for (const [i, ofPoint] of parts.entries()) {
    if (i % AT_ONCE === 0) yield
    for (const { cluster, weight, turn, change } of ofPoint) {
      squares[cluster]!.turn += weight * (turn / reach.x) ** 2
      squares[cluster]!.change += weight * (change / reach.y) ** 2
    }
  }
  const texels = clusters.flatMap(({ θ, frequency }, i) => {
    const { turn, change } = squares[i]!
    return [Math.cos(θ), Math.sin(θ), frequency, turn / Math.max(turn + change, 1e-12)]
  })
  const texture = yield* clusterTexture(foil, parts, texels, reach, mostCells)
  return { count, reach, texture }
}

/** Centres of clusters, each the mean of what is closer to it than to any other. */
function* clusterCentres(points: readonly Point[], count: number): Steps<Point[]> {
  const step = Math.ceil(points.length / MOST_SAMPLES)
  const samples = points.filter((_, i) => i % step === 0)
  // To begin with, each is what is furthest from all before it.
  const centres: Point[] = [samples[0]!]
  const gaps = samples.map(() => Infinity)
  while (centres.length < count) {
    const last = centres[centres.length - 1]!
    let furthest = 0
    samples.forEach((point, i) => {
      gaps[i] = Math.min(gaps[i]!, distance2(point, last))
      if (gaps[i] > gaps[furthest]!) furthest = i
    })
    centres.push(samples[furthest]!)
    yield
  }
  for (let iteration = 0; iteration < ITERATIONS; iteration++) {
    const sums = centres.map(() => ({ x: 0, y: 0, frequency: 0, count: 0 }))
    for (const [i, point] of samples.entries()) {
      if (i % AT_ONCE === 0) yield
      const sum = sums[nearest(point, centres)]!
      sum.x += point[0]
      sum.y += point[1]
      sum.frequency += Math.hypot(...point)
      sum.count++
    }
    // The mean of points on an arc lies within it: its length is that of their mean frequency.
    sums.forEach(({ x, y, frequency, count }, i) => {
      const stretch = frequency / count / Math.max(Math.hypot(x, y), 1e-12)
      if (count > 0) centres[i] = [x * stretch, y * stretch]
    })
  }
  return centres
}

function distance2(a: Point, b: Point): number {
  return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2
}

function nearest(point: Point, centres: readonly Point[]): number {
  let best = 0
  let least = Infinity
  centres.forEach((centre, i) => {
    const gap = distance2(point, centre)
    if (gap < least) [best, least] = [i, gap]
  })
  return best
}

/** The median distance from a centre to its nearest neighbour. */
function typicalGap(centres: readonly Point[]): number {
  const gaps = centres.map((centre, i) => {
    const others = centres.filter((_, j) => j !== i)
    return Math.sqrt(distance2(centre, others[nearest(centre, others)]!))
  })
  return gaps.sort((a, b) => a - b)[gaps.length >> 1]!
}

/** Clusters that a grating belongs to, and how much: the sum is 1. */
function weights(point: Point, centres: readonly Point[], deviation: number): [number, number][] {
  const distances2 = centres.map((centre) => distance2(point, centre))
  const least = Math.min(...distances2)
  const found = distances2
    .map((d2, i): [number, number] => [i, Math.exp((least - d2) / (2 * deviation ** 2))])
    .filter(([, weight]) => weight > SMALLEST_WEIGHT)
  const sum = found.reduce((total, [, weight]) => total + weight, 0)
  return found.map(([cluster, weight]) => [cluster, weight / sum])
}

/** Means over the cells that the map is divided into, as half floats. */
function* clusterTexture(
  { width, height, numberAt, strengthAt }: FoilGratings,
  parts: readonly (readonly Part[])[],
  centres: readonly number[],
  reach: Vector2,
  mostCells: number,
): Steps<DataArrayTexture> {
  const scale = Math.min(mostCells / Math.max(width, height), 1)
  const columns = Math.max(Math.round(scale * width), 1)
  const rows = Math.max(Math.round(scale * height), 1)
  const cells = columns * rows
  const count = centres.length / 4
  const sums = new Float32Array(4 * (count + 2) * cells)
  const texels = new Float32Array(cells)
  for (const [texel, number] of numberAt.entries()) {
    if (texel % width === 0) yield
    const row = Math.floor((Math.floor(texel / width) * rows) / height)
    const cell = row * columns + Math.floor(((texel % width) * columns) / width)
    texels[cell]!++
    if (number < 0) continue
    for (const { cluster, weight, turn, change } of parts[number]!) {
      const share = weight * strengthAt[texel]!
      const [x, y] = [turn / reach.x, change / reach.y]
      const at = 4 * (cluster * cells + cell)
      sums[at]! += share
      sums[at + 1]! += share * x
      sums[at + 2]! += share * y
      sums[at + 3]! += share * (x * x + y * y)
    }
    sums[4 * (count * cells + cell)]! += strengthAt[texel]!
  }
  // There is a texel for each: clusters are no more than gratings, and these no more than texels.
  centres.forEach((number, i) => {
    sums[4 * (count + 1) * cells + i] = number * texels[(i >> 2) % cells]!
  })
  // Most are zero: a loop that passes over them takes a tenth of the time of Uint16Array.from().
  const means = new Uint16Array(sums.length)
  for (let i = 0; i < sums.length; i++) {
    if (i % (4 * cells) === 0) yield
    if (sums[i] !== 0) means[i] = DataUtils.toHalfFloat(sums[i]! / texels[(i >> 2) % cells]!)
  }
  return averagedLayers(means, columns, rows, count + 2, LinearMipmapNearestFilter)
}
