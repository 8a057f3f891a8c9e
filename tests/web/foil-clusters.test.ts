import { DataUtils } from 'three'
import { describe, expect, it } from 'vitest'
import { atOnce } from '../../web/steps'
import { foilClusters, type FoilClusters } from '../../web/surfaces/foil-clusters'
import type { FoilGratings } from '../../web/surfaces/foil-gratings'

/** A row of texels, each another grating: evenly turned through π, of one period. */
function turning(count: number, height = 1): FoilGratings {
  const texels = count * height
  return {
    θ: Array.from({ length: count }, (_, i) => Math.PI * ((i + 0.5) / count - 0.5)),
    frequency: Array.from({ length: count }, () => 0.6),
    width: count,
    height,
    numberAt: Int32Array.from({ length: texels }, (_, i) => i % count),
    strengthAt: new Float32Array(texels).fill(0.5),
    isWhole: false,
  }
}

/** What of each cluster a cell has: its share and, off its centre, the moments of its gratings times their share. */
function partsOf({ count, texture, reach }: FoilClusters, cell: number) {
  const { width, height, data } = texture.image
  const texel = (layer: number, at: number) =>
    [0, 1, 2, 3].map((c) => DataUtils.fromHalfFloat(data![4 * (layer * width * height + at) + c]!))
  return Array.from({ length: count }, (_, i) => {
    const [share, turn, change, squares] = texel(i, cell)
    const [cos, sin, frequency] = texel(count + 1, i)
    return {
      θ: Math.atan2(sin!, cos!),
      frequency: frequency!,
      share: share!,
      turn: turn! * reach.x,
      change: change! * reach.y,
      squares: squares!,
    }
  })
}

/** The share that diffracts, as the layer after the clusters' has it. */
function strengthOf({ count, texture }: FoilClusters, cell: number): number {
  const { width, height, data } = texture.image
  return DataUtils.fromHalfFloat(data![4 * (count * width * height + cell)]!)
}

describe('the clusters of a foil', () => {
  it('show a texel of one grating as that grating, without spread', () => {
    const foil = turning(200)
    const clusters = atOnce(foilClusters(foil, 32, 256))
    for (const texel of [0, 37, 111, 199]) {
      const parts = partsOf(clusters, texel).filter(({ share }) => share > 0)
      expect(parts.length).toBeLessThan(6)
      expect(parts.reduce((sum, { share }) => sum + share, 0)).toBeCloseTo(0.5, 3)
      for (const { θ, frequency, share, turn, change, squares } of parts) {
        expect(Math.abs(Math.sin(θ + turn / share - foil.θ[texel]!))).toBeLessThan(1e-3)
        expect(frequency + change / share).toBeCloseTo(0.6, 3)
        // Half floats leave 2e-3 of the square.
        const means2 = (turn / clusters.reach.x) ** 2 + (change / clusters.reach.y) ** 2
        expect(Math.abs(squares / share - means2 / share ** 2)).toBeLessThan(4e-3)
      }
    }
  })

  it('make an even spread of orientations even', () => {
    const clusters = atOnce(foilClusters(turning(2560), 32, 64))
    const cells = Array.from({ length: 64 }, (_, cell) => partsOf(clusters, cell))
    const parts = cells[0]!.map((first, i) => {
      const sum = (of: 'share' | 'turn' | 'change' | 'squares') =>
        cells.reduce((total, cell) => total + cell[i]![of] / 64, 0)
      const change2 = (sum('change') / sum('share') / clusters.reach.y) ** 2
      const variance = sum('squares') / sum('share') - change2
      return { θ: first.θ, share: sum('share'), turn: sum('turn'), variance }
    })
    const density = (θ: number) =>
      parts.reduce((total, part) => {
        const turn = part.turn / part.share
        const variance = part.variance * clusters.reach.x ** 2 - turn ** 2
        const off = θ - part.θ - turn
        const nearest = off - Math.PI * Math.round(off / Math.PI)
        return (
          total + (part.share / Math.sqrt(variance)) * Math.exp(-(nearest ** 2) / (2 * variance))
        )
      }, 0)
    const even = (0.5 / Math.PI) * Math.sqrt(2 * Math.PI)
    const found = Array.from({ length: 500 }, (_, i) => density((Math.PI * i) / 500) / even)
    expect(Math.max(...found)).toBeLessThan(1.05)
    expect(Math.min(...found)).toBeGreaterThan(0.95)
  })

  it('hold the means of what is in a cell, texels without a grating among it', () => {
    const foil = turning(512)
    foil.numberAt[1] = -1
    const clusters = atOnce(foilClusters(foil, 32, 256))
    for (const [cell, strength] of [0.25, 0.5].entries()) {
      const sum = partsOf(clusters, cell).reduce((total, { share }) => total + share, 0)
      expect(sum).toBeCloseTo(strength, 3)
      expect(strengthOf(clusters, cell)).toBeCloseTo(strength, 3)
    }
  })

  it('keep periods apart that differ', () => {
    const foil = turning(400)
    const frequency = foil.frequency.map((_, i) => (i % 2 === 0 ? 0.5 : 0.9))
    const clusters = atOnce(foilClusters({ ...foil, frequency }, 64, 256))
    expect(clusters.reach.y).toBeLessThan(0.1)
  })
})
