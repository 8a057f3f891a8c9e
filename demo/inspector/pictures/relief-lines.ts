import type { Steps } from '../../../web/steps'
import { make } from '../../ui/elements'
import { css } from '../optics/display'
import type { Colour } from '../optics/light-spectrum'
import { sumOf } from '../optics/orders'
import { strongestLines, type Relief } from '../optics/relief'
import type { PointOptics } from '../point-optics'
import { Block } from './block'
import { number, percent } from './numbers'

const SIZE = 360
const GREEN = 0.55
/** Powers of ten from black to white. */
const DECADES = 5

/** |A|² of a relief's lines over spatial frequency, and where each visible wavelength reads them. */
export class ReliefLines {
  readonly block: Block
  readonly #canvas = make('canvas', 'square')
  /** The last picture of lines alone: it goes with w, which changes as the surface turns. */
  #lines: { relief: Relief; w: number; image: HTMLCanvasElement; strongest: string } | null = null

  constructor() {
    this.#canvas.width = this.#canvas.height = 2 * SIZE
    this.block = new Block('Spectrum of the relief', true, this.#canvas)
  }

  *show(optics: PointOptics, colours: readonly Colour[]): Steps<void> {
    const { relief: surface, wi, wo, tables } = optics
    this.block.element.hidden = surface === null
    if (surface === null || !this.block.isOpen) return
    const { relief } = surface
    const [u, v, w] = sumOf(wi, wo)
    const reach = reachOf(relief)
    // To a hundredth: what is smaller is not seen.
    const depth = Math.max(Math.round(100 * w) / 100, 0)
    if (this.#lines?.relief !== relief || this.#lines.w !== depth)
      this.#lines = { relief, w: depth, ...(yield* drawnLines(relief, depth, reach)) }
    const context = this.#canvas.getContext('2d')!
    const place = (f: number): number => SIZE * (1 + f / reach)
    context.imageSmoothingEnabled = false
    context.drawImage(this.#lines.image, 0, 0, 2 * SIZE, 2 * SIZE)
    context.lineWidth = 5
    tables.spectrum.wavelengths.forEach((wavelength, cell) => {
      if (cell === 0) return
      const before = tables.spectrum.wavelengths[cell - 1]!
      context.strokeStyle = css(colours[cell]!)
      context.beginPath()
      context.moveTo(place(u / before), 2 * SIZE - place(v / before))
      context.lineTo(place(u / wavelength), 2 * SIZE - place(v / wavelength))
      context.stroke()
    })
    this.block.describe(
      `Share |A|² of the light in each line over spatial frequency, ±${number(reach)} 1/µm along the patch’s x and y, at 550 nm, ` +
        `${DECADES} powers of ten from black to white. Strongest, (f_x, f_y) in 1/µm: ${this.#lines.strongest}. The coloured stroke is where the view ` +
        `reads them: f = (u, v)/λ, u = ${number(u)}, v = ${number(v)}, from 380 to 780 nm.`,
    )
  }
}

/** The largest frequency that any direction and visible wavelength can reach, or that the map holds. */
function reachOf(relief: Relief): number {
  const held = Math.max(...relief.frequency(relief.lines).map(Math.abs))
  return Math.min(held, 2 / 0.38)
}

function* drawnLines(
  relief: Relief,
  w: number,
  reach: number,
): Steps<{ image: HTMLCanvasElement; strongest: string }> {
  const limit = relief.lines.map((most, k) => Math.min(most, Math.floor(reach * relief.patch[k]!)))
  const [across, along] = limit as [number, number]
  // A line a pixel, at least so large that single ones of a coarse spectrum are small squares.
  const [columns, rows] = relief.patch.map((length) =>
    Math.max(2 * Math.floor(reach * length) + 1, 61),
  )
  const image = make('canvas', '')
  Object.assign(image, { width: columns, height: rows })
  const context = image.getContext('2d')!
  const pixels = context.createImageData(columns!, rows!)
  for (let i = 3; i < pixels.data.length; i += 4) pixels.data[i] = 255
  const power = relief.powers(w, GREEN)
  for (let j = -across; j <= across; j++) {
    yield
    for (let l = -along; l <= along; l++) {
      const share = power([j, l])
      const level = 255 * Math.min(Math.max(1 + Math.log10(Math.max(share, 1e-12)) / DECADES, 0), 1)
      const [fx, fy] = relief.frequency([j, l])
      const column = Math.round(((fx / reach + 1) / 2) * (columns! - 1))
      const row = Math.round(((1 - fy / reach) / 2) * (rows! - 1))
      const at = 4 * (row * columns! + column)
      if (level > pixels.data[at]!) pixels.data.fill(level, at, at + 3)
    }
  }
  context.putImageData(pixels, 0, 0)
  const strongest = strongestLines(relief, w, GREEN)
    .slice(0, 4)
    .map(({ line, power }) => {
      const [fx, fy] = relief.frequency(line)
      return `(${number(fx, 2)}, ${number(fy, 2)}) ${percent(power)}`
    })
    .join(', ')
  return { image, strongest }
}
