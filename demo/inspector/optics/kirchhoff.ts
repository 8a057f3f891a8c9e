import type { Direction } from './orders'

/** Stam's obliquity (1 + ω_i·ω_o)²/(cosθ_i cosθ_o w²), with the floor of shaders/kirchhoff.glsl. */
export function kirchhoffFactor(wi: Direction, wo: Direction): number {
  const w = wi[2] + wo[2]
  const g = 1 + wi[0] * wo[0] + wi[1] * wo[1] + wi[2] * wo[2]
  return g ** 2 / Math.max(wi[2] * wo[2] * w ** 2, 1e-6)
}
