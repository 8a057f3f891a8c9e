import { MathUtils } from 'three'
import { turnOf, type DragMode, type Movable } from './drag'

const STEP = MathUtils.degToRad(4)
const ZOOM = 1.1

const ARROWS: Partial<Record<string, [right: number, down: number]>> = {
  ArrowLeft: [-STEP, 0],
  ArrowRight: [STEP, 0],
  ArrowUp: [0, -STEP],
  ArrowDown: [0, STEP],
}

/** Arrow keys on the view do what dragging does, plus and minus move the camera in and out. */
export function listenToKeys(
  canvas: HTMLCanvasElement,
  movable: Movable,
  mode: () => DragMode,
): void {
  canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return
    const arrow = ARROWS[event.key]
    if (arrow !== undefined) turnOf(mode(), movable)(...arrow)
    else if (event.key === '+' || event.key === '=') movable.orbit.dollyIn(ZOOM)
    else if (event.key === '-') movable.orbit.dollyOut(ZOOM)
    else return
    event.preventDefault()
    movable.changed()
  })
}
