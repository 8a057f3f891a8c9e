import { Foil, Grating } from '../../../web'
import { arrayOf, valuesOf } from '../../../web/maps/load'

/** The grating at one place of a surface. */
export interface GratingAt {
  /** Angle from growing u to the grating vector, rad, known modulo π. */
  orientation: number
  /** Period, µm; null where nothing diffracts. */
  period: number | null
  /** Share of the place that diffracts, 0 to 1. */
  strength: number
  /** Of a foil: the texel of its map, from the left and from the top. */
  texel: { column: number; row: number } | null
}

/** What grating lies at texture coordinates (u, v). */
export function gratingAt(surface: Foil | Grating, u: number, v: number): GratingAt {
  return surface instanceof Foil ? foilTexel(surface, u, v) : ofGrating(surface, u, v)
}

/** The texel of a foil's map that is at (u, v), from the left and from the top. */
export function texelAt(foil: Foil, u: number, v: number): { column: number; row: number } {
  const [rows, columns] = sizeOf(foil)
  const wrapped = (x: number): number => x - Math.floor(x)
  return {
    column: Math.min(Math.floor(wrapped(u * foil.repeat.x) * columns), columns - 1),
    row: rows - 1 - Math.min(Math.floor(wrapped(v * foil.repeat.y) * rows), rows - 1),
  }
}

/** Rows and columns of a foil's map. */
export function sizeOf(foil: Foil): [rows: number, columns: number] {
  const [rows, columns] = arrayOf(foil.map, 'grating').spec.shape
  return [rows!, columns!]
}

function foilTexel(foil: Foil, u: number, v: number): GratingAt {
  const texel = texelAt(foil, u, v)
  const { spec, data } = arrayOf(foil.map, 'grating')
  const at = 4 * (texel.row * spec.shape[1]! + texel.column)
  const [cos2, sin2, frequency, strength] = valuesOf({ spec, data: data.subarray(at, at + 4) })
  return {
    orientation: Math.atan2(sin2!, cos2!) / 2,
    period: frequency! > 0 && strength! > 0 ? 1 / frequency! : null,
    strength: Math.min(Math.max(strength!, 0), 1),
    texel,
  }
}

function ofGrating(
  { orientation, tracks, period, strength }: Grating,
  u: number,
  v: number,
): GratingAt {
  const turn = tracks === 'circular' ? Math.atan2(v - 0.5, u - 0.5) : 0
  return { orientation: orientation + turn, period, strength, texel: null }
}
