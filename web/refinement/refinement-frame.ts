import type { Object3D } from 'three'

/** One of the frames whose mean is the picture. */
export interface RefinementFrame {
  /** Its index, from 0. */
  index: number
  /** How many there are, a power of 2. */
  count: number
}

const frames = new WeakMap<Object3D, RefinementFrame>()

/** Which frame of its refinement is being drawn of a scene; null: it is one that stands alone. */
export function refinementFrame(scene: Object3D): RefinementFrame | null {
  return frames.get(scene) ?? null
}

/** Runs `draw` with the materials in the scene knowing which frame it is. */
export function drawRefinementFrame(
  scene: Object3D,
  frame: RefinementFrame,
  draw: () => void,
): void {
  frames.set(scene, frame)
  try {
    draw()
  } finally {
    frames.delete(scene)
  }
}
