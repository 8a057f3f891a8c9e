import { drawing, svg } from './svg'

/** One axis of a chart. */
export interface ChartAxis {
  from: number
  to: number
  ticks: readonly number[]
  /** With its unit. */
  label: string
  /** How a tick is written. */
  write: (value: number) => string
}

const MARGIN = { left: 46, right: 14, top: 8, bottom: 36 }
const WIDTH = 360

/** Axes with ticks and labels, and a place within them for curves. */
export class Chart {
  readonly element: SVGSVGElement
  readonly #frame = svg('g', { class: 'axes' })
  readonly #content = svg('g', {})
  #x: ChartAxis | null = null
  #y: ChartAxis | null = null

  constructor(readonly height: number) {
    this.element = drawing(WIDTH, height)
    this.element.append(this.#frame, this.#content)
  }

  /** Draws anew. */
  draw(x: ChartAxis, y: ChartAxis, ...content: SVGElement[]): void {
    this.#x = x
    this.#y = y
    const { left, right, top, bottom } = MARGIN
    const [end, base] = [WIDTH - right, this.height - bottom]
    this.#frame.replaceChildren(
      svg('path', { d: `M${left} ${top}V${base}H${end}`, class: 'axis' }),
      ...x.ticks.map((tick) =>
        svg('text', { x: this.x(tick), y: base + 14, 'text-anchor': 'middle' }, x.write(tick)),
      ),
      ...y.ticks.flatMap((tick) => [
        svg('path', { d: `M${left} ${Math.round(this.y(tick))}H${end}`, class: 'grid' }),
        svg('text', { x: left - 5, y: this.y(tick) + 4, 'text-anchor': 'end' }, y.write(tick)),
      ]),
      svg('text', { x: (left + end) / 2, y: this.height - 4, 'text-anchor': 'middle' }, x.label),
      svg(
        'text',
        { transform: `translate(10 ${(top + base) / 2}) rotate(-90)`, 'text-anchor': 'middle' },
        y.label,
      ),
    )
    this.#content.replaceChildren(...content)
  }

  /** Where a value is along the x axis; the axes of the last `draw`, or of this one. */
  x(value: number, axis = this.#x!): number {
    const { left, right } = MARGIN
    return left + ((value - axis.from) / (axis.to - axis.from)) * (WIDTH - right - left)
  }

  y(value: number, axis = this.#y!): number {
    const { top, bottom } = MARGIN
    const base = this.height - bottom
    return base - ((value - axis.from) / (axis.to - axis.from)) * (base - top)
  }

  /** A curve through points of both axes. */
  curve(
    x: ChartAxis,
    y: ChartAxis,
    points: Iterable<readonly [number, number]>,
    name: string,
  ): SVGPathElement {
    const places = Array.from(
      points,
      ([a, b]) => `${this.x(a, x).toFixed(1)} ${this.y(b, y).toFixed(1)}`,
    )
    return svg('path', { d: `M${places.join('L')}`, class: `curve ${name}` })
  }
}

/** The visible spectrum in nm. */
export const WAVELENGTH_AXIS: ChartAxis = {
  from: 380,
  to: 780,
  ticks: [400, 500, 600, 700],
  label: 'wavelength λ, nm',
  write: String,
}
