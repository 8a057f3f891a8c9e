import { readAtMost } from '../maps/streams.ts'
import { bitByBit, type Steps } from '../steps.ts'

const SIGNATURE = Uint8Array.of(0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a)
const CHANNELS = 4
/** Each byte less the one above it: what is alike from row to row, as foils are, deflates best. */
const FILTER_UP = 2
/** Bytes of a checksum before work may be left. */
const AT_ONCE = 1 << 16

/**
 * Encodes bytes, 4 a pixel, rows from top to bottom, as a PNG of 8-bit RGBA: what web/maps/png.ts reads. No canvas, for the
 * reasons stated there.
 */
export async function encodePng(
  pixels: Uint8Array,
  [height, width]: readonly [number, number],
): Promise<Uint8Array<ArrayBuffer>> {
  const header = new DataView(new ArrayBuffer(13))
  header.setUint32(0, width)
  header.setUint32(4, height)
  header.setUint8(8, 8) // bits
  header.setUint8(9, 6) // RGBA
  const stream = new Blob([await bitByBit(filtered(pixels, height, CHANNELS * width))])
    .stream()
    .pipeThrough(new CompressionStream('deflate'))
  const deflated = (await readAtMost(stream, Infinity))!
  return joined([
    SIGNATURE,
    await chunk('IHDR', new Uint8Array(header.buffer)),
    await chunk('IDAT', deflated),
    await chunk('IEND', new Uint8Array()),
  ])
}

/** Row by row. */
function* filtered(
  pixels: Uint8Array,
  height: number,
  stride: number,
): Steps<Uint8Array<ArrayBuffer>> {
  const rows = new Uint8Array(height * (1 + stride))
  for (let row = 0; row < height; row++) {
    yield
    const target = row * (1 + stride)
    rows[target] = FILTER_UP
    for (let i = 0; i < stride; i++) {
      const above = row === 0 ? 0 : pixels[(row - 1) * stride + i]!
      rows[target + 1 + i] = pixels[row * stride + i]! - above
    }
  }
  return rows
}

/** Length, type, data, checksum. */
async function chunk(type: string, data: Uint8Array): Promise<Uint8Array> {
  const bytes = new Uint8Array(12 + data.length)
  const view = new DataView(bytes.buffer)
  view.setUint32(0, data.length)
  for (let i = 0; i < 4; i++) bytes[4 + i] = type.charCodeAt(i)
  bytes.set(data, 8)
  view.setUint32(8 + data.length, await bitByBit(crc32(bytes.subarray(4, 8 + data.length))))
  return bytes
}

/** ISO/IEC 15948, annex D, by its table of what a byte makes. */
function* crc32(bytes: Uint8Array): Steps<number> {
  const table = Uint32Array.from({ length: 256 }, (_, byte) => {
    let crc = byte
    for (let bit = 0; bit < 8; bit++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0)
    return crc
  })
  let crc = 0xffffffff
  for (let i = 0; i < bytes.length; i++) {
    if (i % AT_ONCE === 0) yield
    crc = (crc >>> 8) ^ table[(crc ^ bytes[i]!) & 0xff]!
  }
  return ~crc >>> 0
}

function joined(parts: readonly Uint8Array[]): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(parts.reduce((length, part) => length + part.length, 0))
  let position = 0
  for (const part of parts) {
    bytes.set(part, position)
    position += part.length
  }
  return bytes
}
