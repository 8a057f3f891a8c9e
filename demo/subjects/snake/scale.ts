import { RingGeometry, Vector3, type BufferGeometry } from 'three'

export interface ScaleShape {
  /** Half length along the body and half width around it, in radii of the body. */
  size: readonly [number, number]
  /** Slope by which the end towards the tail is raised over the scales that it overlaps. */
  lift: number
  /** Curvature beside the body's own, in inverse radii of it. */
  dome: number
}

/** Between 1, a rhombus, and 2, an ellipse. */
const ROUNDNESS = 1.35

/**
 * One scale of a body of radius 1: x towards the tail, y around the body, z outwards. Its uv square is its own, u along x.
 */
export function scaleGeometry({ size: [length, width], lift, dome }: ScaleShape): BufferGeometry {
  const geometry = new RingGeometry(0, 1, 16, 2)
  const position = geometry.getAttribute('position')
  const normal = geometry.getAttribute('normal')
  const uv = geometry.getAttribute('uv')
  const outward = new Vector3()
  for (let i = 0; i < position.count; i++) {
    const [x, y] = onOutline(position.getX(i), position.getY(i))
    const [a, b] = [length * x, width * y]
    position.setXYZ(i, a, b, lift * a - (dome * a * a + (1 + dome) * b * b) / 2)
    outward.set(dome * a - lift, (1 + dome) * b, 1).normalize()
    normal.setXYZ(i, outward.x, outward.y, outward.z)
    uv.setXY(i, (1 + x) / 2, (1 + y) / 2)
  }
  geometry.computeTangents()
  return geometry
}

/** Moves a point of the unit disc along its radius into |x|ⁿ + |y|ⁿ ≤ 1. */
function onOutline(x: number, y: number): [number, number] {
  const radius = Math.hypot(x, y)
  if (radius === 0) return [0, 0]
  const norm = (Math.abs(x) ** ROUNDNESS + Math.abs(y) ** ROUNDNESS) ** (1 / ROUNDNESS)
  return [(x * radius) / norm, (y * radius) / norm]
}
