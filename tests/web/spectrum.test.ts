import { DataUtils } from 'three'
import { afterAll, beforeAll, describe, expect, it, vi } from 'vitest'
import { arrayOf, constantOf, loadMap, valuesOf, type LoadedMap } from '../../web/maps/load'
import { stepTexture } from '../../web/maps/step-texture'
import { arcNodes } from '../../web/spectrum/arc-nodes'
import { lobeTexture } from '../../web/spectrum/lobe-texture'
import { maxOrder } from '../../web/spectrum/max-order'
import { metalReflectance } from '../../web/spectrum/metal-reflectance'
import { solvePositive } from '../../web/spectrum/solve-positive'
import {
  nodesTexture,
  seenIn,
  spectralNodes,
  type Placement,
} from '../../web/spectrum/spectral-nodes'
import { serveBakedMaps } from './baked-maps'

let lobes: LoadedMap
let metals: LoadedMap
let sinusoidal: LoadedMap
let rectangular: LoadedMap

beforeAll(async () => {
  serveBakedMaps()
  lobes = await loadMap('maps/baked/lobes-1931-2-D65')
  metals = await loadMap('maps/baked/metals')
  sinusoidal = await loadMap('maps/baked/profile-sinusoidal')
  rectangular = await loadMap('maps/baked/profile-rectangular')
})

afterAll(() => {
  vi.unstubAllGlobals()
})

describe('the texture of efficiencies', () => {
  it('holds each efficiency and its step to the next phase', () => {
    const array = arrayOf(rectangular, 'efficiency')
    const [height, width] = array.spec.shape as [number, number]
    const { image } = stepTexture(rectangular, 'efficiency')
    expect(image).toMatchObject({ width, height })
    const efficiencies = valuesOf(array)
    const texels = image.data as Float32Array
    for (let i = 0; i < efficiencies.length; i++) {
      expect(texels[2 * i]).toBe(efficiencies[i])
      const isLast = (i + 1) % width === 0
      const next = isLast ? efficiencies[i]! : efficiencies[i + 1]!
      expect(texels[2 * i]! + texels[2 * i + 1]!).toBeCloseTo(next, 6)
    }
    expect(stepTexture(rectangular, 'efficiency')).toBe(stepTexture(rectangular, 'efficiency'))
  })

  it('can leave out its first rows', () => {
    const [height, width] = arrayOf(rectangular, 'efficiency').spec.shape as [number, number]
    const whole = stepTexture(rectangular, 'efficiency').image.data as Float32Array
    const { image } = stepTexture(rectangular, 'efficiency', 16)
    expect(image).toMatchObject({ width, height: height - 16 })
    expect(image.data).toEqual(whole.subarray(2 * 16 * width))
  })

  it('is the same for orders ±m where its map says so', () => {
    for (const map of [sinusoidal, rectangular]) {
      const values = valuesOf(arrayOf(map, 'efficiency'))
      const [rows, columns] = arrayOf(map, 'efficiency').spec.shape as [number, number]
      expect(constantOf(map, 'symmetric')).toEqual([1])
      for (let row = 0; row < rows; row++)
        expect(values.subarray(row * columns, (row + 1) * columns)).toEqual(
          values.subarray((rows - 1 - row) * columns, (rows - row) * columns),
        )
    }
  })
})

describe('spectral nodes', () => {
  const cases: [number, Placement][] = [
    [1, 'weighted'],
    [12, 'weighted'],
    [20, 'weighted'],
    [21, 'uniform'],
    [401, 'uniform'],
  ]

  it.each(cases)('%s of them, %s, add up to white', (count, placement) => {
    const nodes = spectralNodes(lobes, count, placement)
    expect(nodes).toHaveLength(count)
    const white = [0, 1, 2].map((c) =>
      nodes.reduce((sum, { tints }) => sum + tints[c]! + tints[c + 3]! + tints[c + 6]!, 0),
    )
    constantOf(lobes, 'white_xyz').forEach((expected, c) => {
      // The three tint bases add up to 1 within 1e-5.
      expect(white[c]).toBeCloseTo(expected, 4)
    })
  })

  it.each(cases)('%s of them, %s, cover the visible range side by side', (count, placement) => {
    let edge = 0.3795
    for (const { wavelength, bandwidth } of spectralNodes(lobes, count, placement)) {
      expect(wavelength).toBeGreaterThan(edge)
      expect(wavelength).toBeLessThan(edge + bandwidth)
      edge += bandwidth
    }
    expect(edge).toBeCloseTo(0.7805, 9)
  })

  it('have the first moment of the spectrum, so that a linear function is summed exactly', () => {
    const energy = (tints: number[]): number => tints.reduce((a, b) => a + b, 0)
    const moment = (count: number, placement: Placement): number =>
      spectralNodes(lobes, count, placement).reduce(
        (sum, { wavelength, tints }) => sum + wavelength * energy(tints),
        0,
      )
    // Uniform nodes of 1 nm are the data's own; 6 nodes at the middle of their bands would be off by 1e-3.
    expect(moment(6, 'weighted')).toBeCloseTo(moment(401, 'uniform'), 4)
  })

  it('come with the reflectance of the metal in their texture', () => {
    const nodes = spectralNodes(lobes, 3, 'uniform')
    const seen = seenIn(nodes, (wavelength) => 10 * wavelength)
    const { data, height } = nodesTexture(seen).image as { data: Float32Array; height: number }
    const { wavelength, bandwidth, tints } = nodes[2]!
    const texel = (row: number): number[] => [
      ...data.subarray(4 * (3 * row + 2), 4 * (3 * row + 3)),
    ]
    const expected = (...values: number[]): unknown =>
      values.map((value) => expect.closeTo(10 * wavelength * value, 6) as number)
    const [white, red, green] = [texel(0), texel(1), texel(2)]
    expect(height).toBe(3)
    expect(red.slice(0, 3)).toEqual(expected(...tints.slice(0, 3)))
    expect(green.slice(0, 3)).toEqual(expected(...tints.slice(3, 6)))
    const blue = [0, 1, 2].map((c) => white[c]! - red[c]! - green[c]!)
    expect(blue).toEqual(expected(...tints.slice(6, 9)))
    expect([white[3], red[3]]).toEqual([Math.fround(wavelength), Math.fround(bandwidth)])
  })
})

describe('nodes along an arc', () => {
  const metal = (wavelength: number): number => 0.5 + wavelength
  const counts = [1, 2, 12, 26, 401]

  /** ∫ W R L dλ by nanometres: nine numbers. */
  function integral(radiance: (wavelength: number) => number): number[] {
    const cells = seenIn(spectralNodes(lobes, 401, 'uniform'), metal)
    return sumOver(cells, radiance)
  }

  function sumOver(
    nodes: readonly { wavelength: number; tints: number[] }[],
    radiance: (wavelength: number) => number,
  ): number[] {
    return Array.from({ length: 9 }, (_, c) =>
      nodes.reduce((sum, { wavelength, tints }) => sum + tints[c]! * radiance(wavelength), 0),
    )
  }

  function distance(a: readonly number[], b: readonly number[]): number {
    return Math.hypot(...a.map((value, i) => value - b[i]!))
  }

  it.each(counts)('%s of them sum an even radiance exactly, in a metal', (count) => {
    const nodes = arcNodes(lobes, count, metal)
    expect(nodes).toHaveLength(count)
    const even = (): number => 1
    expect(distance(sumOver(nodes, even), integral(even))).toBeLessThan(1e-9)
  })

  it.each(counts)('%s of them lie in bands side by side over the visible range', (count) => {
    let edge = 0.3795
    for (const { wavelength, bandwidth } of arcNodes(lobes, count, metal)) {
      expect(wavelength).toBeGreaterThan(edge)
      expect(wavelength).toBeLessThan(edge + bandwidth)
      edge += bandwidth
    }
    expect(edge).toBeCloseTo(0.7805, 9)
  })

  it('err least: what grows as the variogram from two of the nodes cancels', () => {
    // The equations of ordinary kriging: Σ W_i γ(λ_i, λ_j) + μ = ∫ W γ(λ, λ_j) dλ, with one μ for all nodes j.
    // Where a weight would be below zero it is left out, and they do not hold.
    const nodes = arcNodes(lobes, 12, metal)
    const columns = [0, 1, 2, 3, 4, 5, 6, 7, 8].filter((c) =>
      nodes.every(({ tints }) => tints[c]! > 0),
    )
    expect(columns.length).toBeGreaterThan(1)
    const grows = (j: number) => (wavelength: number) =>
      Math.abs(wavelength - nodes[j]!.wavelength) ** 1.5
    for (const j of [1, 5, 11]) {
      const radiance = (wavelength: number): number => grows(j)(wavelength) - grows(0)(wavelength)
      const [found, exact] = [sumOver(nodes, radiance), integral(radiance)]
      for (const c of columns) expect(found[c]).toBeCloseTo(exact[c]!, 9)
    }
  })

  it('of many frames sum an even radiance exactly, each frame for itself', () => {
    const even = (): number => 1
    const nodes = arcNodes(lobes, 12, metal, 8)
    expect(nodes).toHaveLength(96)
    for (let frame = 0; frame < 8; frame++) {
      const own = nodes.slice(12 * frame, 12 * (frame + 1))
      expect(distance(sumOver(own, even), integral(even))).toBeLessThan(1e-9)
      // One in each of twelve bands, in order.
      for (let i = 1; i < 12; i++)
        expect(own[i]!.wavelength).toBeGreaterThan(own[i - 1]!.wavelength)
    }
  })

  it.each([2, 4, 8])('of %s frames err less in the mean than in each', (frames) => {
    const mean = arcNodes(lobes, 12, metal, frames).map((node) => ({
      ...node,
      tints: node.tints.map((tint) => tint / frames),
    }))
    const single = arcNodes(lobes, 12, metal)
    let [shared, alone] = [0, 0]
    for (const period of [0.05, 0.06, 0.07, 0.09, 0.12, 0.2]) {
      const stripes = (wavelength: number): number => Math.sin((2 * Math.PI * wavelength) / period)
      const exact = integral(stripes)
      shared += distance(sumOver(mean, stripes), exact)
      alone += distance(sumOver(single, stripes), exact)
    }
    expect(shared).toBeLessThan(alone / frames)
  })

  it.each(counts)('%s of them make no light dark', (count) => {
    for (const { tints } of arcNodes(lobes, count, metal))
      expect(Math.min(...tints)).toBeGreaterThanOrEqual(0)
  })

  it('follow stripes of light more closely than as many uniform ones', () => {
    for (const period of [0.12, 0.2, 0.4]) {
      const stripes = (wavelength: number): number => Math.sin((2 * Math.PI * wavelength) / period)
      const exact = integral(stripes)
      const uniform = seenIn(spectralNodes(lobes, 21, 'uniform'), metal)
      const error = distance(sumOver(arcNodes(lobes, 21, metal), stripes), exact)
      expect(error).toBeLessThan(0.3 * distance(sumOver(uniform, stripes), exact))
    }
  })
})

describe('equations of a positive definite matrix', () => {
  /** Of a function of row and column that is symmetric; what is left of the diagonal is not to be read. */
  function matrix(size: number, at: (i: number, j: number) => number): Float64Array[] {
    return Array.from({ length: size }, (_, i) =>
      Float64Array.from({ length: size }, (_, j) => (j < i ? NaN : at(i, j))),
    )
  }

  function times(at: (i: number, j: number) => number, column: Float64Array): Float64Array {
    return column.map((_, i) => column.reduce((sum, value, j) => sum + at(i, j) * value, 0))
  }

  it.each([1, 2, 3])('are solved for several right sides: %s of them', (size) => {
    // L Lᵀ of the rows 2; 1, 3; −1, 0.5, 1.
    const whole = [
      [4, 2, -2],
      [2, 10, 0.5],
      [-2, 0.5, 2.25],
    ]
    const at = (i: number, j: number): number => whole[i]![j]!
    const solution = [
      [1, 2, -3],
      [-2, 0.5, 4],
    ].map((column) => Float64Array.from(column.slice(0, size)))
    const columns = solution.map((column) => times(at, column))
    solvePositive(matrix(size, at), columns)
    columns.forEach((column, c) => {
      column.forEach((value, i) => {
        expect(value).toBeCloseTo(solution[c]![i]!, 12)
      })
    })
  })

  it('are solved where as many as nodes can be stand for a path that is nearly smooth', () => {
    const at = (i: number, j: number): number =>
      ((i + 1) / 400) ** 1.5 + ((j + 1) / 400) ** 1.5 - (Math.abs(i - j) / 400) ** 1.5
    const solution = new Float64Array(400).map((_, i) => Math.sin(i))
    const columns = [times(at, solution)]
    solvePositive(matrix(400, at), columns)
    // The matrix' largest eigenvalue is 1e6 times its least.
    const worst = Math.max(...columns[0]!.map((value, i) => Math.abs(value - solution[i]!)))
    expect(worst).toBeLessThan(1e-9)
  })
})

describe('the lobes of a metal', () => {
  it('are those of white light times its reflectance at their mean wavenumber', () => {
    const halved = lobeTexture(lobes, () => 0.5).image.data as Uint16Array
    const plain = lobeTexture(lobes, () => 1).image.data as Uint16Array
    for (let i = 0; i < plain.length; i += 997) {
      const scale = i % 4 === 3 ? 1 : 0.5
      expect(DataUtils.fromHalfFloat(halved[i]!)).toBeCloseTo(
        scale * DataUtils.fromHalfFloat(plain[i]!),
        4,
      )
    }
  })

  it('know gold from silver', () => {
    const gold = metalReflectance(metals, 'gold')
    const silver = metalReflectance(metals, 'silver')
    expect(gold(0.45)).toBeLessThan(0.5)
    expect(gold(0.65)).toBeGreaterThan(0.9)
    expect(silver(0.45)).toBeGreaterThan(0.95)
  })
})

describe('the largest order shown', () => {
  it('is 8 for a sinusoid of period 3 µm and height 0.3 µm', () => {
    // J_8²(4.96) = 3e-4 is seen, J_9² = 3e-5 is not.
    expect(maxOrder(sinusoidal, 3, 0.3)).toBe(8)
  })

  it('is what can propagate where the profile sends light far out', () => {
    expect(maxOrder(rectangular, 3, 0.3)).toBe(15)
    expect(maxOrder(rectangular, 0.6, 0.3)).toBe(3)
  })

  it('falls with the height, and is none where the period is below half a wavelength', () => {
    expect(maxOrder(sinusoidal, 3, 0.02)).toBe(2)
    expect(maxOrder(sinusoidal, 0.15, 0.3)).toBe(0)
  })
})
