import { byId, make } from '../ui/elements'

/** A press that moves less than this and is shorter is a tap: CSS pixels, ms. */
const TAP = { distance: 6, time: 500 }
const STEP = 4
const LONG_STEP = 24

const ARROWS: Partial<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
}

/** The mark over the view: put elsewhere by a tap, or by arrow keys while it has the focus. */
export class Crosshair {
  readonly #element = make('button', 'crosshair')
  readonly #canvas = byId('view', HTMLCanvasElement)
  #pressed: { x: number; y: number; time: number; id: number } | null = null
  #place = { x: 0.5, y: 0.5 }

  /** @param onMove - asks for a place, from the view's left and top, 0 to 1 */
  constructor(private readonly onMove: (x: number, y: number) => void) {
    this.#element.type = 'button'
    this.#element.setAttribute('aria-label', 'Inspected point: arrow keys move it')
    this.#element.addEventListener('keydown', (event) => {
      const arrow = ARROWS[event.key]
      if (arrow === undefined) return
      event.preventDefault()
      const { clientWidth, clientHeight } = this.#canvas
      const step = event.shiftKey ? LONG_STEP : STEP
      this.onMove(
        this.#place.x + (step * arrow[0]) / clientWidth,
        this.#place.y + (step * arrow[1]) / clientHeight,
      )
    })
  }

  show(): void {
    byId('stage', HTMLElement).append(this.#element)
    this.#canvas.addEventListener('pointerdown', this.#press)
    this.#canvas.addEventListener('pointerup', this.#release)
  }

  hide(): void {
    this.#element.remove()
    this.#canvas.removeEventListener('pointerdown', this.#press)
    this.#canvas.removeEventListener('pointerup', this.#release)
  }

  /** @param isSeen - whether the point faces the camera */
  move(x: number, y: number, isSeen: boolean): void {
    this.#place = { x, y }
    this.#element.style.left = `${100 * x}%`
    this.#element.style.top = `${100 * y}%`
    this.#element.classList.toggle('turned-away', !isSeen)
  }

  readonly #press = (event: PointerEvent): void => {
    const { clientX: x, clientY: y, timeStamp: time, pointerId: id } = event
    this.#pressed = event.button === 0 && event.isPrimary ? { x, y, time, id } : null
  }

  readonly #release = (event: PointerEvent): void => {
    const from = this.#pressed
    this.#pressed = null
    if (from?.id !== event.pointerId || event.timeStamp - from.time > TAP.time) return
    if (Math.hypot(event.clientX - from.x, event.clientY - from.y) > TAP.distance) return
    const { clientWidth, clientHeight } = this.#canvas
    this.onMove(event.offsetX / clientWidth, event.offsetY / clientHeight)
  }
}
