import type { LoadedMap } from '../../web/maps/load'
import type { FoilFacts, StoredFoil } from './foil-map'
import type { PeriodEdit } from './period-edit'
import type { StochasticRecipe } from './stochastic-recipe'

/** A foil that was made in the page: what of, and what came of it. */
export interface Design {
  /** The shapes that were strewn; null where it began from a foil with an address. */
  recipe: StochasticRecipe | null
  /** Periods that its gratings were given then, and the foil that had not got them yet. */
  edited: { edit: PeriodEdit; source: LoadedMap } | null
  foil: StoredFoil
  facts: FoilFacts
}

/** What a foil is called that has been given no name. */
export const DEFAULT_NAME = 'my-foil'
