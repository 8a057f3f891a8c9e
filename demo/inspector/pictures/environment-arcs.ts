import type { Steps } from '../../../web/steps'
import { make } from '../../ui/elements'
import { css, toneMapped } from '../optics/display'
import type { EnvironmentLight } from '../optics/environment-light'
import { orderShares } from '../optics/grating-brdf'
import type { Colour } from '../optics/light-spectrum'
import { lineDirection, orderDirection, type Direction } from '../optics/orders'
import { strongestLines } from '../optics/relief'
import type { PointOptics } from '../point-optics'
import { Block } from './block'
import { degrees, percent, signed } from './numbers'

const [WIDTH, HEIGHT] = [720, 360]
/** Lines of a relief whose arcs are drawn. */
const LINES = 12
/** Steps along an arc, nm. */
const STEP = 4
const GREEN = 0.55

/** Directions from which light of 380 to 780 nm reaches the eye, and the share of it that does. */
interface Arc {
  name: string
  share: number
  at: (wavelength: number) => Direction | null
}

/** The environment, and in it the arcs from which the point's light comes. */
export class EnvironmentArcs {
  readonly block: Block
  readonly #canvas = make('canvas', 'wide')
  #ground: { light: EnvironmentLight; exposure: number; image: ImageData } | null = null

  constructor() {
    Object.assign(this.#canvas, { width: WIDTH, height: HEIGHT })
    this.block = new Block('Arcs in the environment', true, this.#canvas)
  }

  /** @param light - null where there is no environment */
  *show(
    optics: PointOptics,
    light: EnvironmentLight | null,
    exposure: number,
    colours: readonly Colour[],
  ): Steps<void> {
    if (!this.block.isOpen) return
    this.#canvas.hidden = light === null
    if (light === null) {
      this.block.describe('There is no environment: the flash alone lights the scene.')
      return
    }
    const context = this.#canvas.getContext('2d')!
    if (this.#ground?.light !== light || this.#ground.exposure !== exposure)
      this.#ground = { light, exposure, image: yield* thumbnail(light, exposure) }
    context.putImageData(this.#ground.image, 0, 0)
    const { wo, axes, tables } = optics
    const place = (direction: Direction): [number, number] => {
      const { x, y } = light.place(...inWorld(axes, direction))
      return [x * WIDTH, y * HEIGHT]
    }
    const arcs = wo[2] > 0 ? arcsOf(optics) : []
    // A dark edge first, so that arcs are seen on what is bright.
    for (const edge of [true, false])
      for (const { share, at } of arcs) {
        context.lineWidth = edge ? 7 : 2 + 3 * Math.cbrt(Math.min(share, 1))
        let before: [number, number] | null = null
        for (let cell = 0; cell < tables.spectrum.wavelengths.length; cell += STEP) {
          const direction = at(tables.spectrum.wavelengths[cell]!)
          const now = direction && place(direction)
          // Not across the seam.
          if (now && before && Math.abs(now[0] - before[0]) < WIDTH / 2) {
            context.strokeStyle = edge ? 'rgb(0 0 0 / 0.5)' : css(colours[cell]!)
            context.beginPath()
            context.moveTo(...before)
            context.lineTo(...now)
            context.stroke()
          }
          before = now
        }
      }
    context.font = '600 20px system-ui, sans-serif'
    context.textAlign = 'center'
    for (const { name, share, at } of arcs) {
      const direction = at(GREEN)
      if (direction === null || share < 2e-3) continue
      const [x, y] = place(direction)
      outlined(context, name, x, y - 12)
    }
    if (wo[2] > 0) {
      const [x, y] = place([-wo[0], -wo[1], wo[2]])
      context.lineWidth = 3
      for (const [color, radius] of [
        ['#000', 10],
        ['#fff', 8],
      ] as const) {
        context.strokeStyle = color
        context.beginPath()
        context.arc(x, y, radius, 0, 2 * Math.PI)
        context.stroke()
      }
    }
    this.block.describe(describe(optics, arcs, light))
  }
}

function arcsOf({ grating, relief, wo }: PointOptics): Arc[] {
  if (relief !== null)
    return strongestLines(relief.relief, 2 * wo[2], GREEN)
      .slice(0, LINES + 1)
      .filter(({ line }) => line.some((number) => number !== 0))
      .map(({ line, power }) => {
        const frequency = relief.relief.frequency(line)
        return {
          name: `${signed(line[0])},${signed(line[1])}`,
          share: power,
          at: (wavelength) => lineDirection(wo, frequency, wavelength),
        }
      })
  const optics = grating?.optics
  if (!optics) return []
  const arcs: Arc[] = []
  const shares = orderShares(optics, wo, GREEN)
  for (let order = -optics.maxOrder; order <= optics.maxOrder; order++)
    if (order !== 0)
      arcs.push({
        name: signed(order),
        share: shares[order + optics.maxOrder]!,
        at: (wavelength) => orderDirection(wo, order, wavelength, optics.period),
      })
  return arcs
}

function describe(
  { wo, axes, relief }: PointOptics,
  arcs: readonly Arc[],
  light: EnvironmentLight,
): string {
  if (wo[2] <= 0) return 'The point is turned away from the camera: no light of it is seen.'
  const what = relief === null ? 'order' : 'line (numbers along x and y)'
  const listed = arcs
    .filter(({ share }) => share > 2e-3)
    .map(({ name, share, at }) => {
      const green = at(GREEN)
      if (green === null) return null
      const { x, y } = light.place(...inWorld(axes, green))
      const [azimuth, height] = [(x - 0.5) * 2 * Math.PI, (0.5 - y) * Math.PI]
      return `${name} from ${degrees(azimuth, 0)}, ${degrees(height, 0)} (${percent(share)})`
    })
    .filter((text) => text !== null)
  const from = listed.length === 0 ? 'no order but the mirror’s' : listed.join('; ')
  return (
    `All directions around the object, ±180° across, ±90° up. Each ${what} brings light of 380 to 780 nm to the eye from an arc, ` +
    `drawn in its colours; at 550 nm azimuth, height and share of the light: ${from}. Ring: the mirror’s direction.`
  )
}

/** A direction of the point's axes in the world's. */
function inWorld(
  axes: PointOptics['axes'],
  [t, b, n]: Direction,
): [x: number, y: number, z: number] {
  const [a, c, d] = axes
  return [t * a.x + b * c.x + n * d.x, t * a.y + b * c.y + n * d.y, t * a.z + b * c.z + n * d.z]
}

function outlined(context: CanvasRenderingContext2D, text: string, x: number, y: number): void {
  context.strokeStyle = 'rgb(0 0 0 / 0.8)'
  context.lineWidth = 5
  context.lineJoin = 'round'
  context.strokeText(text, x, y)
  context.fillStyle = '#fff'
  context.fillText(text, x, y)
}

function* thumbnail(light: EnvironmentLight, exposure: number): Steps<ImageData> {
  const image = new ImageData(WIDTH, HEIGHT)
  // At half the picture's resolution, which is what the page shows of it: a quarter of the time.
  for (let y = 0; y < HEIGHT; y += 2) {
    for (let x = 0; x < WIDTH; x += 2) {
      const rgb = light.texel(
        Math.floor(((x + 1) / WIDTH) * light.width),
        Math.floor(((y + 1) / HEIGHT) * light.height),
      )
      const shown = toneMapped(rgb, exposure)
      for (const at of [0, 1, WIDTH, WIDTH + 1])
        image.data.set([...shown, 255], 4 * (y * WIDTH + x + at))
    }
    yield
  }
  return image
}
