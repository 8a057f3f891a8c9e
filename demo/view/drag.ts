import { Vector3, type Camera } from 'three'
import type { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import type { Flash } from '../light/flash'
import type { Tilt } from './tilt'

export const DRAG_MODES = { camera: 'Camera', object: 'Object', flash: 'Flash' } as const
export type DragMode = keyof typeof DRAG_MODES

/** A pointer this near to the flash takes hold of it in any mode, CSS pixels. */
const REACH = 24
/** Turn of what is dragged across the height of the view, rad. */
const TURN = Math.PI

/** Turns about the vertical and the horizontal axis, rad; positive: to the right, down. */
export type Turn = (right: number, down: number) => void

export interface Movable {
  orbit: OrbitControls
  tilt: Tilt
  flash: Flash
  camera: Camera
  changed: () => void
}

/** The turn that a mode stands for. */
export function turnOf(mode: DragMode, { orbit, tilt, flash, changed }: Movable): Turn {
  return (right, down) => {
    switch (mode) {
      case 'camera':
        orbit.rotateLeft(right)
        orbit.rotateUp(down)
        break
      case 'object':
        tilt.turn(right, down)
        break
      case 'flash':
        flash.azimuth += right
        flash.height -= down
        break
    }
    changed()
  }
}

/** Lets a pointer drag object or flash; the camera is OrbitControls' own business, touch and pinch included. */
export function listenToDrags(
  canvas: HTMLCanvasElement,
  movable: Movable,
  mode: () => DragMode,
): void {
  let turn: Turn | null = null
  let pointer = -1
  let [x, y] = [0, 0]

  // Before OrbitControls' own listener, which looks at `enabled` first.
  canvas.addEventListener(
    'pointerdown',
    (event) => {
      if (turn !== null || event.button !== 0) return
      const held = isNearFlash(event, canvas, movable) ? 'flash' : mode()
      if (held === 'camera') return
      movable.orbit.enabled = false
      turn = turnOf(held, movable)
      pointer = event.pointerId
      canvas.setPointerCapture(pointer)
      x = event.clientX
      y = event.clientY
    },
    { capture: true },
  )
  canvas.addEventListener('pointermove', (event) => {
    if (turn === null || event.pointerId !== pointer) return
    const scale = TURN / canvas.clientHeight
    turn((event.clientX - x) * scale, (event.clientY - y) * scale)
    x = event.clientX
    y = event.clientY
  })
  const release = (event: PointerEvent): void => {
    if (event.pointerId !== pointer) return
    turn = null
    pointer = -1
    movable.orbit.enabled = true
  }
  canvas.addEventListener('pointerup', release)
  canvas.addEventListener('pointercancel', release)
}

function isNearFlash(
  event: PointerEvent,
  canvas: HTMLCanvasElement,
  { flash, camera }: Movable,
): boolean {
  if (!flash.object.visible) return false
  const { x, y, z } = flash.object.getWorldPosition(new Vector3()).project(camera)
  const dx = ((x + 1) / 2) * canvas.clientWidth - event.offsetX
  const dy = ((1 - y) / 2) * canvas.clientHeight - event.offsetY
  return z < 1 && Math.hypot(dx, dy) < REACH
}
