import type { Page } from 'playwright-core'

/** Pixels of a screenshot: red, green, blue and alpha, 0 to 255. */
export type Pixels = number[]

/** Width that screenshots are brought to, pixels: what is looked for is larger than a pixel. */
const WIDTH = 240

/** Decodes a screenshot, in the page that it was taken of, at that width. */
export function pixelsOf(page: Page, png: Buffer, width = WIDTH): Promise<Pixels> {
  return inCanvas(page, png, width, 'pixels')
}

/** The screenshot at that width, as a PNG file. */
export async function pngOf(page: Page, png: Buffer, width: number): Promise<Buffer> {
  return Buffer.from(await inCanvas(page, png, width, 'png'))
}

function inCanvas(
  page: Page,
  png: Buffer,
  width: number,
  result: 'pixels' | 'png',
): Promise<number[]> {
  return page.evaluate(
    async (wanted) => {
      const image = new Image()
      image.src = wanted.address
      await image.decode()
      const canvas = document.createElement('canvas')
      canvas.width = wanted.width
      canvas.height = Math.round((image.height * wanted.width) / image.width)
      const context = canvas.getContext('2d')!
      context.imageSmoothingQuality = 'high'
      context.drawImage(image, 0, 0, canvas.width, canvas.height)
      if (wanted.result === 'pixels')
        return Array.from(context.getImageData(0, 0, canvas.width, canvas.height).data)
      const blob = await new Promise<Blob | null>((resolve) => {
        canvas.toBlob(resolve)
      })
      return Array.from(new Uint8Array(await blob!.arrayBuffer()))
    },
    { address: `data:image/png;base64,${png.toString('base64')}`, width, result },
  )
}

/** Share of the pixels whose red, green and blue meet a condition, 0 to 1. */
export function shareOf(
  pixels: Pixels,
  holds: (r: number, g: number, b: number) => boolean,
): number {
  let count = 0
  for (let i = 0; i < pixels.length; i += 4)
    if (holds(pixels[i]!, pixels[i + 1]!, pixels[i + 2]!)) count++
  return (4 * count) / pixels.length
}

/** Mean of the channels' differences, 0 to 255. */
export function meanDifference(a: Pixels, b: Pixels): number {
  if (a.length !== b.length)
    throw new Error(`${a.length} and ${b.length} values cannot be compared`)
  let sum = 0
  for (let i = 0; i < a.length; i++) sum += Math.abs(a[i]! - b[i]!)
  return sum / a.length
}
