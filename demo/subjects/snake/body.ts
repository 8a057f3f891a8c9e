import { CatmullRomCurve3, Vector3 } from 'three'

export const LENGTH = 5
const THICKEST = 0.16
/** Shares of the length over which head and tail taper. */
const HEAD = 0.06
const TAIL = 0.6
/** Where the neck is and how far along it reaches, as shares of the length, and by what share it is thinner. */
const NECK = { middle: 0.11, reach: 0.05, depth: 0.15 }

const UP = new Vector3(0, 1, 0)
const course = new CatmullRomCurve3(winding())

/**
 * The body's course from snout to tail, on the ground. Its direction swings as a sine of the distance, as that of a
 * river does: no other line bends so evenly.
 */
function winding(): Vector3[] {
  const [swing, waves, start, steps] = [1.6, 1.5, -0.9, 120]
  const points = [new Vector3()]
  for (let i = 0; i < steps; i++) {
    const direction = swing * Math.sin((2 * Math.PI * waves * (i + 0.5)) / steps + start)
    const step = new Vector3(-Math.cos(direction), 0, Math.sin(direction))
    points.push(points[i]!.clone().addScaledVector(step, LENGTH / steps))
  }
  const middle = points[0]!.clone().lerp(points[steps]!, 0.5)
  return points.map((point) => point.sub(middle))
}

/** Radius of the body at a distance from the snout. */
export function radiusAt(distance: number): number {
  const share = distance / LENGTH
  const neck = 1 - NECK.depth * Math.exp(-(((share - NECK.middle) / NECK.reach) ** 2))
  return THICKEST * Math.sqrt(rounded(share / HEAD)) * rounded((1 - share) / TAIL) ** 0.8 * neck
}

/** From 0 at 0 to 1 at 1 and beyond, level there. */
function rounded(share: number): number {
  return 1 - (1 - Math.min(Math.max(share, 0), 1)) ** 2
}

/**
 * A point of the body.
 *
 * @param angle - round from the top of the back, rad
 * @param share - of the radius that the point is away from the middle: 1 on the skin
 */
export function pointAt(distance: number, angle: number, share = 1): Vector3 {
  const place = Math.min(Math.max(distance / LENGTH, 0), 1)
  const radius = radiusAt(distance)
  const across = new Vector3().crossVectors(UP, course.getTangentAt(place))
  return course
    .getPointAt(place)
    .addScaledVector(UP, radius * (1 + share * Math.cos(angle)))
    .addScaledVector(across, radius * share * Math.sin(angle))
}
