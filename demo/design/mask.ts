import { bitByBit, type Steps } from '../../web/steps'
import { areaOf, type Figure } from './figures'
import { refusal } from './values'

/** More than a shape has texels, and what a picture of so many may take. */
const MOST_PIXELS = 2048
const MOST_BYTES = 1 << 24
const SIGNATURE = [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]
/** Where the header states them, bytes from the beginning. */
const [WIDTH, HEIGHT, BITS, HEADER_END] = [16, 20, 24, 33]

/**
 * The light and opaque half of a PNG, as `precompute.foils.shapes.mask` has it. Throws a DiffractionError where it is none,
 * or too large.
 */
export async function readMask(file: File): Promise<Figure> {
  const header = new DataView(await file.slice(0, HEADER_END).arrayBuffer())
  if (header.byteLength < HEADER_END || SIGNATURE.some((byte, i) => header.getUint8(i) !== byte))
    throw refusal('mask', file.name, 'a PNG file')
  const [width, height] = [header.getUint32(WIDTH), header.getUint32(HEIGHT)]
  if (width > MOST_PIXELS || height > MOST_PIXELS || file.size > MOST_BYTES)
    throw refusal(
      'mask',
      `${width} × ${height}`,
      `at most ${MOST_PIXELS} × ${MOST_PIXELS} pixels and ${MOST_BYTES >> 20} MB, not ${width} × ${height}`,
    )
  const bits = header.getUint8(BITS)
  if (bits > 8) throw refusal('mask', bits, `8 bits a channel, not ${bits}`)
  const isOn = figureOf(await bitByBit(lightOf(await pixelsOf(file))), height, width)
  const area = areaOf(isOn)
  if (area === 0) throw refusal('mask', file.name, 'a light, opaque figure, not all dark or clear')
  return { isOn, area }
}

/** The longer side is as long as the box. */
function figureOf(light: Uint8Array, rows: number, columns: number): Figure['isOn'] {
  const longer = Math.max(rows, columns)
  return (x, y) => {
    const column = Math.floor(x * longer + columns / 2)
    const row = Math.floor(-y * longer + rows / 2)
    const isWithin = column >= 0 && column < columns && row >= 0 && row < rows
    return isWithin && light[row * columns + column] === 1
  }
}

/** 1 where luma (ITU-R 601, in 16 bits, as Pillow has it) times alpha is a half or more. */
function* lightOf(pixels: Uint8Array): Steps<Uint8Array> {
  const light = new Uint8Array(pixels.length / 4)
  for (let i = 0; i < light.length; i++) {
    if (i % MOST_PIXELS === 0) yield
    const at = 4 * i
    const luma =
      (19595 * pixels[at]! + 38470 * pixels[at + 1]! + 7471 * pixels[at + 2]! + 0x8000) >> 16
    light[i] = (luma / 255) * (pixels[at + 3]! / 255) >= 0.5 ? 1 : 0
  }
  return light
}

/**
 * A picture's bytes, 4 a pixel, rows from the top. By WebGL: a canvas's own context would multiply colours by alpha and apply
 * colour profiles.
 */
async function pixelsOf(file: File): Promise<Uint8Array> {
  let picture: ImageBitmap
  try {
    picture = await createImageBitmap(file, {
      premultiplyAlpha: 'none',
      colorSpaceConversion: 'none',
    })
  } catch {
    throw refusal('mask', file.name, 'a PNG that is whole')
  }
  const { width, height } = picture
  const gl = document.createElement('canvas').getContext('webgl2')!
  const texture = gl.createTexture()
  gl.bindTexture(gl.TEXTURE_2D, texture)
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, picture)
  picture.close()
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer())
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0)
  const pixels = new Uint8Array(4 * width * height)
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels)
  gl.getExtension('WEBGL_lose_context')?.loseContext()
  return pixels
}
