import { expect, it } from 'vitest'
import { decodePng } from '../../web/maps/png'
import { pngOf } from './fake-maps'

const WIDTH = 7
const HEIGHT = 5
const STRIDE = 4 * WIDTH

/** Filters rows as a writer would, one filter a row, straight from the definitions. */
function filterRows(pixels: Uint8Array, filterOf: (row: number) => number): Uint8Array {
  const at = (row: number, i: number): number => (row < 0 || i < 0 ? 0 : pixels[row * STRIDE + i]!)
  const rows: number[] = []
  for (let row = 0; row < HEIGHT; row++) {
    const filter = filterOf(row)
    rows.push(filter)
    for (let i = 0; i < STRIDE; i++) {
      const left = at(row, i - 4)
      const up = at(row - 1, i)
      const corner = i < 4 ? 0 : at(row - 1, i - 4)
      const estimate = left + up - corner
      const [nearest] = [left, up, corner]
        .map((value) => ({ value, distance: Math.abs(estimate - value) }))
        .sort((a, b) => a.distance - b.distance)
      const predictions = [0, left, up, Math.floor((left + up) / 2), nearest!.value]
      rows.push((pixels[row * STRIDE + i]! - predictions[filter]! + 256) % 256)
    }
  }
  return Uint8Array.from(rows)
}

function headerOf(): Uint8Array {
  const ihdr = new Uint8Array(13)
  const view = new DataView(ihdr.buffer)
  view.setUint32(0, WIDTH)
  view.setUint32(4, HEIGHT)
  ihdr.set([8, 6], 8)
  return ihdr
}

it.each([0, 1, 2, 3, 4])('undoes row filter %i, and all of them mixed', async (filter) => {
  let state = 12345
  const pixels = Uint8Array.from({ length: HEIGHT * STRIDE }, () => {
    state = (state * 1103515245 + 12345) % 2147483648
    return state >> 16
  })
  for (const filterOf of [() => filter, (row: number) => (row + filter) % 5]) {
    const bytes = pngOf(headerOf(), filterRows(pixels, filterOf))
    expect(await decodePng('x.png', bytes, [HEIGHT, WIDTH, 4])).toEqual(pixels)
  }
})
