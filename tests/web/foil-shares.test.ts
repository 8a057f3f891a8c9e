import { afterEach, describe, expect, it, vi } from 'vitest'
import { loadMap } from '../../web/maps/load'
import { atOnce } from '../../web/steps'
import { foilGratings } from '../../web/surfaces/foil-gratings'
import { foilShares } from '../../web/surfaces/foil-shares'
import { fakeFoil, filesOf, serveFiles } from './fake-maps'
import { refuses } from './refuses'

afterEach(() => {
  vi.unstubAllGlobals()
})

/** Stored cos 2θ and sin 2θ: θ = 0 and θ = 90°, near enough for 8 bits. */
const ALONG = [255, 128]
const ACROSS = [0, 128]

async function sharesOf(width: number, height: number, texels: number[][]) {
  const foil = fakeFoil(Uint8Array.from(texels.flat()), [width, height])
  serveFiles(filesOf({ 'maps/foil': foil }))
  return atOnce(foilShares(atOnce(foilGratings(await loadMap('maps/foil')))))
}

describe('the gratings of a foil', () => {
  it('are refused where there are more than 8 bits have of a circle and a frequency', async () => {
    const [width, height] = [512, 513]
    const pixels = new Uint8Array(4 * width * height)
    new Uint32Array(pixels.buffer).forEach((_, i, texels) => (texels[i] = 0xff000000 + 0x10000 + i))
    serveFiles(filesOf({ 'maps/foil': fakeFoil(pixels, [width, height]) }))
    const map = await loadMap('maps/foil')
    refuses(() => atOnce(foilGratings(map)), 'maps/foil.json', 'arrays.grating')
  })
})

describe('the shares of a foil', () => {
  it('has a channel for each grating, rows from the bottom', async () => {
    const shares = await sharesOf(2, 2, [
      [...ALONG, 255, 255],
      [...ACROSS, 255, 51],
      [...ALONG, 255, 0],
      [...ALONG, 128, 102],
    ])
    const { gratings, texture } = shares
    expect(gratings).toHaveLength(3)
    const { data, width, height, depth } = texture.image
    expect([width, height, depth]).toEqual([2, 2, 1])
    // The image's top row is the texture's second.
    expect([...data!]).toEqual([0, 0, 0, 0, 0, 0, 102, 0, 255, 0, 0, 0, 0, 51, 0, 0])
  })

  it('keeps orientation modulo π and the frequency of each', async () => {
    const { gratings } = await sharesOf(2, 1, [
      [...ALONG, 255, 255],
      [...ACROSS, 51, 255],
    ])
    // 8 bits put sin 2θ at 1/255 rather than 0: half of that, and a step of frequency.
    expect(Math.abs(gratings[0]!.x)).toBeCloseTo(1, 4)
    expect(Math.abs(gratings[0]!.y)).toBeLessThan(0.5 / 255 + 1e-6)
    expect(gratings[0]!.z).toBeCloseTo(0.8, 6)
    expect(Math.abs(gratings[1]!.y)).toBeCloseTo(1, 4)
    expect(gratings[1]!.z).toBeCloseTo(0.8 * 0.2, 6)
  })

  it('opens another layer after four gratings', async () => {
    const texels = Array.from({ length: 5 }, (_, i) => [...ALONG, 51 * (i + 1), 255])
    const { texture } = await sharesOf(5, 1, texels)
    expect(texture.image.depth).toBe(2)
    const second = [...texture.image.data!.subarray(4 * 5)]
    expect(second).toEqual([...Array<number>(4 * 4).fill(0), 255, 0, 0, 0])
  })
})
