/** Lookups of the environment for each of a material's nodes. */
const LOOKUPS_PER_NODE = 16

/** What every WebGL 2 can hold along one side of a texture. */
const MAX_LOOKUPS = 2048

/** Steps of w = cosθ_i + cosθ_o, from 0 to 2, at which a sample's colour is stored. */
export const W_STEPS = 33

/** Lookups at most: fewer where a relief has fewer lines. */
export function lookups(environmentNodes: number): number {
  return Math.min(LOOKUPS_PER_NODE * environmentNodes, MAX_LOOKUPS)
}
