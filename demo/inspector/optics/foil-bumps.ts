import type { Vector2, Vector3 } from 'three'
import type { Foil } from '../../../web'
import { arrayOf, valuesOf, type LoadedMap } from '../../../web/maps/load'

const known = new WeakMap<LoadedMap, Float32Array>()

/**
 * A frame bent by a foil's bumps as shaders/surfaces/foil.glsl bends it: (t, b, n) orthonormal, t towards growing u.
 *
 * @param uv - texture coordinates
 */
export function bentFrame(
  frame: readonly [Vector3, Vector3, Vector3],
  foil: Foil,
  uv: Vector2,
): [Vector3, Vector3, Vector3] {
  const [p, q] = slopeAt(foil, uv)
  const [t, b, n] = frame
  const combined = (x: number, y: number, z: number): Vector3 =>
    t.clone().multiplyScalar(x).addScaledVector(b, y).addScaledVector(n, z).normalize()
  // With n ∝ (p, q, 1), the direction in which u grows is ∝ (1 + q², −pq, −p), at right angles to (0, 1, −q).
  return [combined(1 + q * q, -p * q, -p), combined(0, 1, -q), combined(p, q, 1)]
}

/** The normal's components along u and v over that along z, blended between texels; tiles go on into each other. */
function slopeAt(foil: Foil, { x: u, y: v }: Vector2): [number, number] {
  const array = arrayOf(foil.map, 'normal')
  const values = known.get(foil.map) ?? valuesOf(array)
  known.set(foil.map, values)
  const [rows, columns] = array.spec.shape as [number, number]
  const channels = array.spec.channels.length
  const x = u * foil.repeat.x * columns - 0.5
  // Rows go down, v goes up.
  const y = (1 - v * foil.repeat.y) * rows - 0.5
  const [left, top] = [Math.floor(x), Math.floor(y)]
  const [s, t] = [x - left, y - top]
  const wrapped = (index: number, count: number): number => ((index % count) + count) % count
  const at = (column: number, row: number, c: number): number =>
    values[channels * (wrapped(row, rows) * columns + wrapped(column, columns)) + c]!
  return [0, 1].map(
    (c) =>
      (1 - t) * ((1 - s) * at(left, top, c) + s * at(left + 1, top, c)) +
      t * ((1 - s) * at(left, top + 1, c) + s * at(left + 1, top + 1, c)),
  ) as [number, number]
}
