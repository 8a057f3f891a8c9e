/** A unit vector away from the surface: along the grating vector t, along the grooves b, along the normal n. */
export type Direction = readonly [t: number, b: number, n: number]

/**
 * cos²θ of order m, below 0 where it does not propagate. Written from ω_n, so that order 0 keeps its cosine however close it
 * is to the horizon.
 *
 * @param direction - ω_i or ω_o: the relation is symmetric
 * @param offset - mλ/a
 */
export function squaredCosine([t, , n]: Direction, offset: number): number {
  return n * n + offset * (2 * t - offset)
}

/**
 * Where order m leaves for, or comes from: (ω_m)_xy = −ω_xy + (mλ/a) t (docs/theory/geometry.md); null where it does not
 * propagate. wavelength, period: µm.
 */
export function orderDirection(
  direction: Direction,
  order: number,
  wavelength: number,
  period: number,
): Direction | null {
  const offset = (order * wavelength) / period
  const squared = squaredCosine(direction, offset)
  return squared > 0 ? [offset - direction[0], -direction[1], Math.sqrt(squared)] : null
}

/** The orders that propagate, rising. wavelength, period: µm. */
export function propagatingOrders(
  direction: Direction,
  wavelength: number,
  period: number,
): number[] {
  const limit = Math.ceil((2 * period) / wavelength)
  return Array.from({ length: 2 * limit + 1 }, (_, i) => i - limit).filter(
    (order) => squaredCosine(direction, (order * wavelength) / period) > 0,
  )
}

/** The sum of two directions, (u, v, w). */
export function sumOf(wi: Direction, wo: Direction): Direction {
  return [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]]
}

/** (ω_i)_xy = λ f − (ω_o)_xy of a line of a relief's spectrum; null below the horizon. frequency: f, 1/µm. */
export function lineDirection(
  wo: Direction,
  [fx, fy]: readonly [number, number],
  wavelength: number,
): Direction | null {
  const [x, y] = [wavelength * fx - wo[0], wavelength * fy - wo[1]]
  const squared = 1 - x * x - y * y
  return squared > 0 ? [x, y, Math.sqrt(squared)] : null
}
