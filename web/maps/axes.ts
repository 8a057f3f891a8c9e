/**
 * Texel ↔ parameter along one axis of a map, as inverse pairs. A texel index is real here: index i stands for
 * the centre of texel i, and the first and the last texel hold the axis' two ends.
 */

export const MAPPINGS = ['linear', 'square', 'log'] as const
/** How the parameter grows from texel to texel: evenly, or as the square or the exponential of what does. */
export type Mapping = (typeof MAPPINGS)[number]

/** What varies along an array's axis, and where its texels lie. */
export interface Axis {
  /** What varies along the axis. */
  name: string
  /** Its symbol. */
  symbol: string
  /** Its unit, as in 'rad'; '1' where it has none. */
  unit: string
  /** Number of texels. */
  size: number
  /** How the parameter grows from texel to texel. */
  mapping: Mapping
  /** Parameter at the first texel, in `unit`. */
  first: number
  /** Parameter at the last texel, in `unit`. */
  last: number
}

/** Texel index (0 … size − 1) → parameter in the axis' unit. */
export function parameterFromTexel(axis: Axis, texel: number): number {
  const x = unitFromTexel(axis, texel)
  switch (axis.mapping) {
    case 'linear':
      return axis.first + (axis.last - axis.first) * x
    case 'square':
      return axis.first + (axis.last - axis.first) * x * x
    case 'log':
      return axis.first * Math.pow(axis.last / axis.first, x)
  }
}

/** Parameter in the axis' unit → texel index. Inverse of {@link parameterFromTexel}. */
export function texelFromParameter(axis: Axis, parameter: number): number {
  const t = (parameter - axis.first) / (axis.last - axis.first)
  switch (axis.mapping) {
    case 'linear':
      return texelFromUnit(axis, t)
    case 'square':
      return texelFromUnit(axis, Math.sqrt(t))
    case 'log':
      return texelFromUnit(
        axis,
        Math.log(parameter / axis.first) / Math.log(axis.last / axis.first),
      )
  }
}

/** Texel index → texture coordinate of that texel's centre. */
export function coordinateFromTexel(axis: Axis, texel: number): number {
  return (texel + 0.5) / axis.size
}

/** Texture coordinate → texel index. Inverse of {@link coordinateFromTexel}. */
export function texelFromCoordinate(axis: Axis, coordinate: number): number {
  return coordinate * axis.size - 0.5
}

function unitFromTexel(axis: Axis, texel: number): number {
  return axis.size > 1 ? texel / (axis.size - 1) : 0
}

function texelFromUnit(axis: Axis, x: number): number {
  return axis.size > 1 ? x * (axis.size - 1) : 0
}
