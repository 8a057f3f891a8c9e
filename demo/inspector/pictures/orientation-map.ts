import { Color } from 'three'
import { Foil, Grating } from '../../../web'
import { arrayOf, valuesOf } from '../../../web/maps/load'
import { bitByBit, type Steps } from '../../../web/steps'
import { make } from '../../ui/elements'
import { gratingAt, sizeOf } from '../optics/grating-at'
import type { PointOptics } from '../point-optics'
import { Block } from './block'
import { degrees, micrometres } from './numbers'

/** Texels along a side of the picture of one grating's tracks. */
const TRACKS_SIZE = 128
/** Saturation of the shortest period; the longest has 1. */
const PALEST = 0.35

/** Orientation as hue all over the surface's uv square, or over one tile of a foil; a place in it can be picked. */
export class OrientationMap {
  readonly block: Block
  readonly #canvas = make('canvas', '')
  readonly #mark = make('span', 'mark')
  readonly #pad = make('div', 'orientation', this.#canvas, this.#mark)
  readonly #pictures = new WeakMap<object, ImageData>()
  #shown: object | null = null
  #optics: PointOptics | null = null

  /** @param pick - takes a place by its texture coordinates */
  constructor(private readonly pick: (u: number, v: number) => void) {
    this.#pad.tabIndex = 0
    this.#pad.setAttribute('role', 'application')
    this.#pad.setAttribute('aria-roledescription', 'map, arrow keys move the picked texel')
    const scale = make('div', 'hues')
    scale.append(...['0°', '45°', '90°', '135°', '180°'].map((angle) => make('span', '', angle)))
    this.block = new Block('Orientation', true, this.#pad, scale)
    this.#pad.addEventListener('click', (event) => {
      const { left, top, width, height } = this.#canvas.getBoundingClientRect()
      this.#take(
        Math.floor(((event.clientX - left) / width) * this.#canvas.width),
        Math.floor(((event.clientY - top) / height) * this.#canvas.height),
      )
    })
    this.#pad.addEventListener('keydown', (event) => {
      const step = STEPS[event.key]
      const place = this.#place()
      if (step === undefined || place === null) return
      event.preventDefault()
      const far = event.shiftKey ? 10 : 1
      this.#take(place.column + far * step[0], place.row + far * step[1])
    })
  }

  async show(optics: PointOptics): Promise<void> {
    const { surface, grating } = optics
    const isDrawn =
      surface instanceof Foil || (surface instanceof Grating && surface.tracks === 'circular')
    this.block.element.hidden = !isDrawn
    if (!isDrawn || grating === null || !this.block.isOpen) return
    this.#optics = optics
    const drawn = surface
    // A grating changes in place, a foil's map never.
    const key = drawn instanceof Foil ? drawn.map : drawn
    const isNew = this.#shown !== key || drawn instanceof Grating
    if (isNew) {
      this.#shown = key
      const made = drawn instanceof Foil ? this.#pictures.get(key) : undefined
      const picture =
        made ?? (await bitByBit(drawn instanceof Foil ? foilPicture(drawn) : tracksPicture(drawn)))
      this.#pictures.set(key, picture)
      if (this.#shown !== key) return
      this.#canvas.width = picture.width
      this.#canvas.height = picture.height
      this.#canvas.getContext('2d')!.putImageData(picture, 0, 0)
    }
    this.#describe(optics)
  }

  #describe({ surface, grating }: PointOptics): void {
    const place = this.#place()!
    this.#mark.style.left = `${(100 * (place.column + 0.5)) / this.#canvas.width}%`
    this.#mark.style.top = `${(100 * (place.row + 0.5)) / this.#canvas.height}%`
    const { at } = grating!
    const here =
      at.period === null
        ? 'nothing diffracts at the mark'
        : `at the mark ${degrees(modulo(at.orientation, Math.PI))}, ${micrometres(at.period)}`
    if (!(surface instanceof Foil)) {
      this.block.describe(`Hue: angle of the grating vector to growing u, modulo 180°; ${here}.`)
      return
    }
    const [rows, columns] = sizeOf(surface)
    const [shortest, longest] = surface.period
    const periods =
      longest < 1.01 * shortest
        ? `all periods ${micrometres(shortest)}`
        : `pale to full: periods ${micrometres(shortest)} to ${micrometres(longest)}`
    this.block.describe(
      `Hue: angle of the grating vector to growing u, modulo 180°; ${periods}; dark: no grating. ` +
        `${columns} × ${rows} texels; column ${place.column}, row ${place.row}: ${here}.`,
    )
  }

  #place(): { column: number; row: number } | null {
    if (this.#optics === null) return null
    const { grating, point } = this.#optics
    if (grating?.at.texel) return grating.at.texel
    return {
      column: Math.min(Math.floor(modulo(point.uv.x, 1) * TRACKS_SIZE), TRACKS_SIZE - 1),
      row:
        TRACKS_SIZE -
        1 -
        Math.min(Math.floor(modulo(point.uv.y, 1) * TRACKS_SIZE), TRACKS_SIZE - 1),
    }
  }

  /** Picks a texel, in the tile that the last point lies in. */
  #take(column: number, row: number): void {
    if (this.#optics === null) return
    const { point, surface } = this.#optics
    const repeat = surface instanceof Foil ? surface.repeat : { x: 1, y: 1 }
    const { width, height } = this.#canvas
    const along = (uv: number, tiles: number, share: number): number =>
      (Math.floor(uv * tiles) + modulo(share, 1)) / tiles
    this.pick(
      along(point.uv.x, repeat.x, (column + 0.5) / width),
      along(point.uv.y, repeat.y, 1 - (row + 0.5) / height),
    )
  }
}

const STEPS: Partial<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
}

function* foilPicture(foil: Foil): Steps<ImageData> {
  const { spec, data } = arrayOf(foil.map, 'grating')
  const [rows, columns] = sizeOf(foil)
  const pixels = new ImageData(columns, rows)
  const paint = painter(pixels.data, foil.period)
  for (let row = 0; row < rows; row++) {
    const values = valuesOf({
      spec,
      data: data.subarray(4 * columns * row, 4 * columns * (row + 1)),
    })
    for (let column = 0; column < columns; column++) {
      const at = 4 * column
      paint(
        row * columns + column,
        Math.atan2(values[at + 1]!, values[at]!) / 2,
        1 / values[at + 2]!,
        values[at + 3]!,
      )
    }
    yield
  }
  return pixels
}

function* tracksPicture(grating: Grating): Steps<ImageData> {
  const pixels = new ImageData(TRACKS_SIZE, TRACKS_SIZE)
  const paint = painter(pixels.data, [grating.period, grating.period])
  for (let row = 0; row < TRACKS_SIZE; row++) {
    for (let column = 0; column < TRACKS_SIZE; column++) {
      const [u, v] = [(column + 0.5) / TRACKS_SIZE, 1 - (row + 0.5) / TRACKS_SIZE]
      const { orientation, strength } = gratingAt(grating, u, v)
      paint(row * TRACKS_SIZE + column, orientation, grating.period, strength)
    }
    yield
  }
  return pixels
}

function painter(
  pixels: Uint8ClampedArray,
  [shortest, longest]: readonly [number, number],
): (pixel: number, orientation: number, period: number, strength: number) => void {
  const color = new Color()
  return (pixel, orientation, period, strength) => {
    const share = longest < 1.01 * shortest ? 1 : (period - shortest) / (longest - shortest)
    const [hue, saturation, value] = [
      modulo(orientation / Math.PI, 1),
      PALEST + (1 - PALEST) * Math.min(Math.max(share, 0), 1),
      period < Infinity ? strength : 0,
    ]
    // From HSV to HSL, in which three takes colours.
    const lightness = value * (1 - saturation / 2)
    const room = Math.min(lightness, 1 - lightness)
    color.setHSL(hue, room === 0 ? 0 : (value - lightness) / room, lightness, '')
    pixels.set([255 * color.r, 255 * color.g, 255 * color.b, 255], 4 * pixel)
  }
}

function modulo(value: number, period: number): number {
  return value - period * Math.floor(value / period)
}
