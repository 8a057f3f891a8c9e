import { refuse } from '../errors.ts'
import { bitByBit, type Steps } from '../steps.ts'
import { readAtMost } from './streams.ts'

const SIGNATURE = [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]
const CHANNELS = 4

/**
 * Decodes a PNG of 8-bit RGBA, the one kind that holds a map, to the bytes that were written: 4 a pixel, rows
 * from top to bottom.
 *
 * A canvas would multiply colour by alpha and a browser may apply a colour profile; to a map, where the
 * channels are not colours and alpha may be zero over valid data, both are damage. Hence no canvas: the
 * browser inflates, and the row filters (ISO/IEC 15948, section 9) are undone here.
 *
 * @param shape - rows and columns that it must have; nothing is inflated beyond them
 */
export async function decodePng(
  file: string,
  bytes: Uint8Array,
  shape: readonly number[],
): Promise<Uint8Array> {
  const signature = Array.from(bytes.subarray(0, SIGNATURE.length))
  if (signature.join() !== SIGNATURE.join()) refuse(file, 'signature', signature, 'that of a PNG')

  const chunks = readChunks(file, bytes)
  const header = chunks.find(({ type }) => type === 'IHDR')?.data
  if (header?.length !== 13) return refuse(file, 'IHDR', header?.length, 'a header of 13 bytes')
  const view = new DataView(header.buffer, header.byteOffset, header.byteLength)
  const width = view.getUint32(0)
  const height = view.getUint32(4)
  if (view.getUint8(8) !== 8) refuse(file, 'IHDR bit depth', view.getUint8(8), '8')
  if (view.getUint8(9) !== 6) refuse(file, 'IHDR colour type', view.getUint8(9), '6 (RGBA)')
  if (view.getUint8(12) !== 0) refuse(file, 'IHDR interlace', view.getUint8(12), '0 (none)')

  if (height !== shape[0] || width !== shape[1])
    refuse(
      file,
      'size (rows, columns)',
      [height, width],
      `${shape.slice(0, 2).join(' × ')}, as in the sidecar`,
    )

  const deflated = chunks.filter(({ type }) => type === 'IDAT').map(({ data }) => data)
  const expectedLength = height * (1 + width * CHANNELS)
  const filtered = await inflate(deflated, expectedLength).catch((cause: unknown) =>
    refuse(file, 'IDAT', 'unreadable', 'complete zlib data', cause),
  )
  if (filtered?.length !== expectedLength)
    return refuse(
      file,
      'IDAT bytes',
      filtered?.length ?? 'more',
      `${expectedLength} after inflation`,
    )
  return bitByBit(unfilter(file, filtered, width, height))
}

function readChunks(file: string, bytes: Uint8Array): { type: string; data: Uint8Array }[] {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength)
  const chunks: { type: string; data: Uint8Array }[] = []
  let position = SIGNATURE.length
  // Length, type, data, checksum: 12 bytes beside the data. The checksum is left to the map's SHA-256.
  while (position + 12 <= bytes.length) {
    const length = view.getUint32(position)
    const data = bytes.subarray(position + 8, position + 8 + length)
    const type = String.fromCharCode(...bytes.subarray(position + 4, position + 8))
    if (position + 12 + length > bytes.length) break
    chunks.push({ type, data })
    if (type === 'IEND') return chunks
    position += 12 + length
  }
  refuse(file, 'bytes', bytes.length, 'chunks up to IEND (the file is truncated)')
}

function inflate(parts: Uint8Array[], most: number): Promise<Uint8Array | undefined> {
  const stream = new Blob(parts as BlobPart[])
    .stream()
    .pipeThrough(new DecompressionStream('deflate'))
  return readAtMost(stream, most)
}

/** Row by row. */
function* unfilter(
  file: string,
  filtered: Uint8Array,
  width: number,
  height: number,
): Steps<Uint8Array> {
  const stride = width * CHANNELS
  const pixels = new Uint8Array(height * stride)
  for (let row = 0; row < height; row++) {
    yield
    const source = row * (stride + 1)
    const target = row * stride
    const filter = filtered[source]!
    if (filter > 4) refuse(file, `filter of row ${row}`, filter, '0 to 4')
    for (let i = 0; i < stride; i++) {
      const left = i < CHANNELS ? 0 : pixels[target + i - CHANNELS]!
      const up = row === 0 ? 0 : pixels[target + i - stride]!
      const upLeft = row === 0 || i < CHANNELS ? 0 : pixels[target + i - stride - CHANNELS]!
      // Uint8Array keeps the sum modulo 256, as the format asks.
      pixels[target + i] = filtered[source + 1 + i]! + predict(filter, left, up, upLeft)
    }
  }
  return pixels
}

function predict(filter: number, left: number, up: number, upLeft: number): number {
  switch (filter) {
    case 1:
      return left
    case 2:
      return up
    case 3:
      return (left + up) >> 1
    case 4:
      return paeth(left, up, upLeft)
    default:
      return 0
  }
}

/** The neighbour nearest to left + up − upLeft, ties in that order. */
function paeth(left: number, up: number, upLeft: number): number {
  const distanceLeft = Math.abs(up - upLeft)
  const distanceUp = Math.abs(left - upLeft)
  const distanceUpLeft = Math.abs(left + up - 2 * upLeft)
  if (distanceLeft <= distanceUp && distanceLeft <= distanceUpLeft) return left
  return distanceUp <= distanceUpLeft ? up : upLeft
}
