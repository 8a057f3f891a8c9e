import type { LoadedMap } from '../maps/load.ts'
import { foilClusters, type FoilClusters } from './foil-clusters.ts'
import { foilGratings, type FoilGratings } from './foil-gratings.ts'
import { foilShares, MOST_GRATINGS, type FoilShares } from './foil-shares.ts'

/**
 * How a foil of many gratings is seen: by lights in so many clusters where a pixel covers more than 8 texels, by an
 * environment, which is smooth in orientation, where it covers more than one. Periods that differ take clusters of their own.
 * Cells are counted along the map's longer side; the two take at most 12 or 23, and 13 MB, mip levels included.
 */
export const CLUSTERS = {
  underLights: { onePeriod: 64, periods: 128, cells: 128 },
  underEnvironment: { clusters: 16, cells: 256 },
}

/** How pixels show the mean of the many texels that they cover. */
export type FoilMean =
  | ({ kind: 'shares' } & FoilShares)
  | { kind: 'clusters'; underLights: FoilClusters; underEnvironment: () => FoilClusters }

/** What all foils that show a map have in common, made when the first asks for it. */
export class FoilContents {
  static readonly #made = new WeakMap<LoadedMap, FoilContents>()
  /** Whether all of the foil diffracts. */
  readonly isWhole: boolean
  readonly #gratings: FoilGratings
  #mean: FoilMean | null = null

  private constructor(
    map: LoadedMap,
    private readonly periods: readonly [number, number],
  ) {
    this.#gratings = foilGratings(map)
    this.isWhole = this.#gratings.isWhole
  }

  /** @param periods - shortest and longest on the map, µm */
  static of(map: LoadedMap, periods: readonly [number, number]): FoilContents {
    let contents = this.#made.get(map)
    if (contents === undefined) this.#made.set(map, (contents = new FoilContents(map, periods)))
    return contents
  }

  /** Null where nothing on the map diffracts. */
  get mean(): FoilMean | null {
    const count = this.#gratings.θ.length
    if (count === 0) return null
    return (this.#mean ??=
      count <= MOST_GRATINGS
        ? { kind: 'shares', ...foilShares(this.#gratings) }
        : this.#clusters(count))
  }

  #clusters(count: number): FoilMean {
    const { underLights, underEnvironment } = CLUSTERS
    const most = isOnePeriod(this.periods) ? underLights.onePeriod : underLights.periods
    let arcs: FoilClusters | undefined
    return {
      kind: 'clusters',
      underLights: foilClusters(this.#gratings, Math.min(count, most), underLights.cells),
      underEnvironment: () =>
        (arcs ??= foilClusters(this.#gratings, underEnvironment.clusters, underEnvironment.cells)),
    }
  }
}

/** Whether one period, but for how finely it is stored, is all there is. */
export function isOnePeriod([shortest, longest]: readonly [number, number]): boolean {
  return longest < 1.01 * shortest
}
