import { MathUtils, type Object3D } from 'three'

const STEEPEST = MathUtils.degToRad(75)
/** A slow, small figure of eight: amplitudes (rad) and angular frequencies (rad/s) of the two turns. */
const SWAY = { x: [0.1, 0.9], y: [0.2, 0.45] } as const

/** How the object is held: turned about a level axis and about the vertical, and swaying if asked. */
export class Tilt {
  isSwaying = false
  #object: Object3D | null = null
  #x = 0
  #y = 0
  #time = 0

  /** Takes up another object, held in a given way. */
  hold(object: Object3D, pose: readonly [number, number]): void {
    this.#object = object
    this.#time = 0
    this.pose = pose
  }

  /** The object's turns about x and y without its swaying, rad. */
  get pose(): readonly [number, number] {
    return [this.#x, this.#y]
  }

  set pose([x, y]: readonly [number, number]) {
    this.#x = MathUtils.clamp(x, -STEEPEST, STEEPEST)
    this.#y = y
    this.#pose()
  }

  turn(right: number, down: number): void {
    this.pose = [this.#x + down, this.#y + right]
  }

  /** Goes on swaying; false if it does not sway. */
  advance(seconds: number): boolean {
    if (!this.isSwaying) return false
    this.#time += seconds
    this.#pose()
    return true
  }

  #pose(): void {
    const [[ax, wx], [ay, wy]] = [SWAY.x, SWAY.y]
    this.#object?.rotation.set(
      this.#x + ax * Math.sin(wx * this.#time),
      this.#y + ay * Math.sin(wy * this.#time),
      0,
    )
  }
}
