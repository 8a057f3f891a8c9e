import { DataTexture, FloatType, RGBAFormat } from 'three'
import { parameterFromTexel, texelFromParameter } from '../maps/axes.ts'
import { arrayOf, type LoadedMap } from '../maps/load.ts'
import { unfiltered } from '../maps/shared-texture.ts'

/** A band of the visible spectrum. */
export interface SpectralNode {
  /** Where the band's weight has its middle, µm. */
  wavelength: number
  /** Its width, µm. */
  bandwidth: number
  /** XYZ of the band in light of the three tint bases: red's, green's, blue's. A mirror's white has Y = 1. */
  tints: number[]
}

/** How bands share out the spectrum: of equal width, or narrower where the eye and the light weigh more. */
export type Placement = 'uniform' | 'weighted'

/**
 * Divides the visible spectrum into bands. Their weights are differences of the map's cumulative table, so that
 * any number of bands adds up to the same white.
 *
 * @param lobes - a map of kind 'lobes'
 * @param count - number of bands, 1 or more; 401 uniform ones are the reference's own nanometres
 */
export function spectralNodes(
  lobes: LoadedMap,
  count: number,
  placement: Placement,
): SpectralNode[] {
  const { spec, data } = arrayOf(lobes, 'weights')
  const axis = spec.axes[0]!
  const channels = spec.channels.length
  const cumulative = (wavelength: number): number[] => {
    const texel = texelFromParameter(axis, wavelength)
    const low = Math.min(Math.max(Math.floor(texel), 0), axis.size - 2)
    const t = texel - low
    return Array.from(
      { length: channels },
      (_, c) => data[low * channels + c]! * (1 - t) + data[(low + 1) * channels + c]! * t,
    )
  }
  const edges = placement === 'uniform' ? uniformEdges(axis, count) : weightedEdges(lobes, count)
  const totals = edges.map(cumulative)
  return totals.slice(1).map((above, i) => {
    const low = edges[i]!
    const high = edges[i + 1]!
    return {
      wavelength: placement === 'uniform' ? (low + high) / 2 : centroid(cumulative, low, high),
      bandwidth: high - low,
      tints: above.map((value, c) => value - totals[i]![c]!),
    }
  })
}

/** Nodes seen in a metal. reflectance: R(λ), λ in µm. */
export function seenIn(
  nodes: readonly SpectralNode[],
  reflectance: (wavelength: number) => number,
): SpectralNode[] {
  return nodes.map((node) => ({
    ...node,
    tints: node.tints.map((value) => value * reflectance(node.wavelength)),
  }))
}

/**
 * Nodes as the texture that shaders/spectrum.glsl reads: a column a node; XYZ of white and λ, of red and bandwidth, and
 * of green. Blue's is the rest.
 */
export function nodesTexture(nodes: readonly SpectralNode[]): DataTexture {
  const rows = new Float32Array(nodes.length * 3 * 4)
  nodes.forEach(({ wavelength, bandwidth, tints }, i) => {
    const white = [0, 1, 2].map((c) => tints[c]! + tints[c + 3]! + tints[c + 6]!)
    const columns = [
      [...white, wavelength],
      [...tints.slice(0, 3), bandwidth],
      [...tints.slice(3, 6), 0],
    ]
    columns.forEach((texel, row) => {
      rows.set(texel, (row * nodes.length + i) * 4)
    })
  })
  return unfiltered(new DataTexture(rows, nodes.length, 3, RGBAFormat, FloatType))
}

type Axis = Parameters<typeof parameterFromTexel>[0]

function uniformEdges(axis: Axis, count: number): number[] {
  return Array.from(
    { length: count + 1 },
    (_, i) => axis.first + ((axis.last - axis.first) * i) / count,
  )
}

/**
 * Half of the bands' density goes with the light's weight X + Y + Z, half is even over the spectrum, so that no band
 * at its dim ends is so wide that its arc could not be filtered.
 */
function weightedEdges(lobes: LoadedMap, count: number): number[] {
  const { spec, data } = arrayOf(lobes, 'weights')
  const axis = spec.axes[0]!
  const channels = spec.channels.length
  const sum = (texel: number): number => {
    let total = 0
    for (let c = 0; c < channels; c++) total += data[texel * channels + c]!
    return total
  }
  const last = axis.size - 1
  const share = Array.from(
    { length: axis.size },
    (_, texel) => (0.5 * sum(texel)) / sum(last) + (0.5 * texel) / last,
  )
  return Array.from({ length: count + 1 }, (_, i) => {
    const target = i / count
    const above = Math.min(
      Math.max(
        share.findIndex((s) => s >= target),
        1,
      ),
      last,
    )
    const t = (target - share[above - 1]!) / (share[above]! - share[above - 1]!)
    return parameterFromTexel(axis, above - 1 + t)
  })
}

/** ∫ λ dW / ∫ dW over a band, by parts: high − ∫ (W(λ) − W(low)) dλ / (W(high) − W(low)). */
function centroid(cumulative: (wavelength: number) => number[], low: number, high: number): number {
  const total = (wavelength: number): number =>
    cumulative(wavelength).reduce((sum, value) => sum + value, 0)
  const steps = 64
  const start = total(low)
  const weight = total(high) - start
  if (weight <= 0) return (low + high) / 2
  let area = 0
  for (let i = 0; i < steps; i++) area += total(low + ((high - low) * (i + 0.5)) / steps) - start
  return high - (((high - low) / steps) * area) / weight
}
