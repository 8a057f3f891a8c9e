import { css } from '../optics/display'
import { orderShares } from '../optics/grating-brdf'
import { lobeCovariance } from '../optics/lobe'
import type { Colour } from '../optics/light-spectrum'
import { propagatingOrders, squaredCosine, sumOf } from '../optics/orders'
import { uniqueId } from '../../ui/elements'
import type { PointOptics } from '../point-optics'
import { Block } from './block'
import { micrometres, nanometres, number, percent, signed } from './numbers'
import { drawing, svg } from './svg'

const [WIDTH, HEIGHT] = [360, 250]
/** Of the plane that is shown: u from −2 to 2, v as far as there is room. */
const SCALE = WIDTH / 4.1
const GREEN = 0.55
/** Steps of a strip's colours. */
const STOPS = 16

/** Where a grating's orders lie over (u, v) = ω_i + ω_o, in their colours, and where the view falls among them. */
export class Lobes {
  readonly block: Block
  readonly #drawing = drawing(WIDTH, HEIGHT)
  readonly #id = uniqueId()

  constructor() {
    this.block = new Block('Lobes over (u, v)', true, this.#drawing)
  }

  /** @param colours - of the spectrum's nanometres, 0 to 255 */
  show(optics: PointOptics, colours: readonly Colour[]): void {
    const grating = optics.grating?.optics
    this.block.element.hidden = optics.grating === null
    if (!this.block.isOpen) return
    if (!grating) {
      this.#drawing.replaceChildren()
      this.block.describe('Nothing diffracts here.')
      return
    }
    const { wi, wo, angularRadius, tables } = optics
    const { wavelengths } = tables.spectrum
    const [u, v, w] = sumOf(wi, wo)
    const defs = svg('defs', {})
    const strips: SVGElement[] = []
    const shares: { order: number; share: number }[] = []
    const atGreen = orderShares(grating, wo, GREEN)
    for (let order = -grating.maxOrder; order <= grating.maxOrder; order++) {
      const share = atGreen[order + grating.maxOrder]!
      if (share > 0) shares.push({ order, share })
      if (order === 0) continue
      const at = (wavelength: number): number => (order * wavelength) / grating.period
      if (Math.abs(at(0.38)) > 2) continue
      const id = `${this.#id}-${order}`
      defs.append(strip(id, at(0.38), at(0.78), colours, wavelengths))
      const { vv } = lobeCovariance(grating, wi, w, angularRadius, GREEN)
      // Two deviations to either side; a lobe that is narrower than a line is shown as one.
      const half = Math.max(2 * Math.sqrt(vv) * SCALE, 1.5)
      const [from, to] = [x(at(0.38)), x(at(0.78))].sort((a, b) => a - b) as [number, number]
      const isOpen = squaredCosine(wo, at(GREEN)) > 0
      strips.push(
        svg('rect', {
          ...{ x: from, y: y(0) - half, width: to - from, height: 2 * half },
          ...{ fill: `url(#${id})`, rx: Math.min(half, 3) },
          // Eyes see brightness by about its cube root.
          opacity: isOpen ? Math.max(Math.cbrt(share), 0.12) : 0.08,
        }),
        svg(
          'text',
          { x: x(at(GREEN)), y: y(0) + half + 13, 'text-anchor': 'middle', class: 'order' },
          signed(order),
        ),
      )
    }
    this.#drawing.replaceChildren(
      defs,
      circle(wi[0], wi[1], 'horizon'),
      circle(wo[0], wo[1], 'horizon eye'),
      svg('path', { d: `M0 ${y(0)}H${WIDTH}M${x(0)} 0V${HEIGHT}`, class: 'axis' }),
      ...strips,
      svg('circle', { cx: x(0), cy: y(0), r: 3.5, class: 'mirror' }),
      svg('circle', { cx: x(u), cy: y(v), r: 7, class: 'view halo' }),
      svg('circle', { cx: x(u), cy: y(v), r: 7, class: 'view' }),
      svg('path', { d: `M${x(u) - 12} ${y(v)}h24M${x(u)} ${y(v) - 12}v24`, class: 'view' }),
      svg('text', { x: WIDTH - 4, y: y(0) - 5, 'text-anchor': 'end' }, 'u'),
      svg('text', { x: x(0) + 5, y: 12 }, 'v'),
    )
    this.block.describe(describe(optics, u, v, shares))
  }
}

function describe(
  { grating, wo, wi }: PointOptics,
  u: number,
  v: number,
  shares: readonly { order: number; share: number }[],
): string {
  const { period, coherence } = grating!.optics!
  const open = propagatingOrders(wo, GREEN, period)
  const listed = shares
    .filter(({ share }) => share > 1e-3)
    .map(({ order, share }) => `${signed(order)}: ${percent(share)}`)
    .join(', ')
  const seen = seenOrders(u, period)
    .map(({ order, wavelength }) => `${signed(order)} at ${nanometres(wavelength)}`)
    .join(', ')
  const falls =
    wi[2] <= 0
      ? 'The flash is below the horizon.'
      : `The view (cross) falls on u = ${number(u)}, v = ${number(v)}; on this u lie ${seen === '' ? 'no orders but the mirror’s' : `orders ${seen}`}.`
  return (
    `Order m is at u = mλ/a, v = 0, a = ${micrometres(period)}; ${open.length} orders propagate at 550 nm, with shares of the ` +
    `light ${listed}. ${falls} Circles: the horizons, dashed of the camera’s fixed direction, dotted of the flash’s; window σ = ${micrometres(coherence)}.`
  )
}

/** Orders that have a visible wavelength at u = mλ/a. */
export function seenOrders(u: number, period: number): { order: number; wavelength: number }[] {
  const most = Math.floor((Math.abs(u) * period) / 0.38)
  return Array.from({ length: most }, (_, i) => Math.sign(u) * (i + 1))
    .map((order) => ({ order, wavelength: (u * period) / order }))
    .filter(({ wavelength }) => wavelength <= 0.78)
}

function strip(
  id: string,
  from: number,
  to: number,
  colours: readonly Colour[],
  wavelengths: readonly number[],
): SVGLinearGradientElement {
  const gradient = svg('linearGradient', {
    ...{ id, gradientUnits: 'userSpaceOnUse' },
    ...{ x1: x(from), x2: x(to), y1: 0, y2: 0 },
  })
  for (let i = 0; i <= STOPS; i++) {
    const cell = Math.round((i / STOPS) * (wavelengths.length - 1))
    gradient.append(svg('stop', { offset: i / STOPS, 'stop-color': css(colours[cell]!) }))
  }
  return gradient
}

function circle(u: number, v: number, name: string): SVGElement {
  return svg('circle', { cx: x(u), cy: y(v), r: SCALE, class: name })
}

function x(u: number): number {
  return WIDTH / 2 + SCALE * u
}

function y(v: number): number {
  return HEIGHT / 2 - SCALE * v
}
