import { MathUtils } from 'three'
import type { Turn } from './drag'

interface PermissionAsker {
  requestPermission?: () => Promise<'granted' | 'denied'>
}

/** Whether the device might tell how it is held; only telephones and tablets have something to tell. */
export function canSenseMotion(): boolean {
  return 'DeviceOrientationEvent' in window && matchMedia('(pointer: coarse)').matches
}

/** Turns what is shown as the device is turned. */
export class Motion {
  #isOn = false
  #last: DeviceOrientationEvent | null = null

  constructor(private readonly turn: Turn) {}

  get isOn(): boolean {
    return this.#isOn
  }

  /** Begins to follow the device; some browsers ask whoever holds it first. Throws where that is refused. */
  async start(): Promise<void> {
    // Not everywhere is there something to ask.
    const asker = DeviceOrientationEvent as unknown as PermissionAsker
    const answer = await asker.requestPermission?.()
    if (answer === 'denied')
      throw new Error('This browser was told not to say how the device is held.')
    this.#last = null
    this.#isOn = true
    window.addEventListener('deviceorientation', this.#follow)
  }

  stop(): void {
    this.#isOn = false
    window.removeEventListener('deviceorientation', this.#follow)
  }

  readonly #follow = (event: DeviceOrientationEvent): void => {
    const last = this.#last
    this.#last = event
    if (last === null) return
    const [right, down] = turnBetween(last, event, screen.orientation.angle)
    if (right !== 0 || down !== 0) this.turn(right, down)
  }
}

/**
 * The turn to the right and down, rad, between two ways to hold a device whose screen is turned by `screenAngle` (°). A
 * surface in it seems to turn with it.
 */
function turnBetween(
  from: DeviceOrientationEvent,
  to: DeviceOrientationEvent,
  screenAngle: number,
): [number, number] {
  const beta = between(from.beta, to.beta)
  const gamma = between(from.gamma, to.gamma)
  const angle = MathUtils.degToRad(screenAngle)
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)]
  return [gamma * cosine + beta * sine, beta * cosine - gamma * sine]
}

/** The shorter way from one angle (°) to another, rad. */
function between(from: number | null, to: number | null): number {
  if (from === null || to === null) return 0
  return MathUtils.degToRad(MathUtils.euclideanModulo(to - from + 180, 360) - 180)
}
