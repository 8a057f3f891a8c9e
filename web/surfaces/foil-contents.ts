import type { LoadedMap } from '../maps/load.ts'
import type { Steps } from '../steps.ts'
import { foilClusters, type FoilClusters } from './foil-clusters.ts'
import { foilGratings, type FoilGratings } from './foil-gratings.ts'
import { foilShares, MOST_GRATINGS, type FoilShares } from './foil-shares.ts'

/**
 * How a foil of many gratings is seen: by lights in so many clusters where a pixel covers more than 8 texels, by an
 * environment, which is smooth in orientation, where it covers more than one. Periods that differ take clusters of their own.
 * Cells are counted along the map's longer side; the two take at most 12 or 23, and 13 MB, mip levels included.
 */
const CLUSTERS = {
  underLights: { onePeriod: 64, periods: 128, cells: 128 },
  underEnvironment: { clusters: 16, cells: 256 },
}

/** How pixels show the mean of the many texels that they cover. */
export type FoilMean =
  | ({ kind: 'shares' } & FoilShares)
  | { kind: 'clusters'; underLights: FoilClusters; underEnvironment: FoilClusters }

/** What all foils that show a map have in common. */
export interface FoilContents {
  /** Whether all of the foil diffracts. */
  isWhole: boolean
  /** Null where nothing on the map diffracts, or it was not asked for. */
  mean: FoilMean | null
}

/** What was made of a map, once for all who ask. */
const made = new WeakMap<LoadedMap, { gratings: FoilGratings; mean?: FoilMean | null }>()

/**
 * The contents of a map.
 *
 * @param periods - shortest and longest on the map, µm
 * @param isFiltered - whether the mean is asked for
 */
export function* foilContents(
  map: LoadedMap,
  periods: readonly [number, number],
  isFiltered: boolean,
): Steps<FoilContents> {
  const gratings = made.get(map)?.gratings ?? (yield* foilGratings(map))
  // Another foil may have been first, while this one waited.
  const known = made.get(map) ?? { gratings }
  made.set(map, known)
  if (isFiltered && known.mean === undefined) {
    const mean = yield* foilMean(known.gratings, periods)
    known.mean ??= mean
  }
  return { isWhole: gratings.isWhole, mean: isFiltered ? known.mean! : null }
}

function* foilMean(
  gratings: FoilGratings,
  periods: readonly [number, number],
): Steps<FoilMean | null> {
  const count = gratings.θ.length
  if (count === 0) return null
  if (count <= MOST_GRATINGS) return { kind: 'shares', ...(yield* foilShares(gratings)) }
  const { underLights, underEnvironment } = CLUSTERS
  const most = Math.min(count, isOnePeriod(periods) ? underLights.onePeriod : underLights.periods)
  // Only a frame tells whether there is an environment, and is no time for such work.
  return {
    kind: 'clusters',
    underLights: yield* foilClusters(gratings, most, underLights.cells),
    underEnvironment: yield* foilClusters(
      gratings,
      underEnvironment.clusters,
      underEnvironment.cells,
    ),
  }
}

/** Whether one period, but for how finely it is stored, is all there is. */
export function isOnePeriod([shortest, longest]: readonly [number, number]): boolean {
  return longest < 1.01 * shortest
}
