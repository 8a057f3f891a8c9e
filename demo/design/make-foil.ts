import type { LoadedMap } from '../../web/maps/load'
import { bitByBit } from '../../web/steps'
import type { Design } from './design'
import { madeFoil, stored, type FoilFacts, type FoilTexels, type StoredFoil } from './foil-map'
import { editedFacts, withPeriods, type PeriodEdit } from './period-edit'
import { stochasticTexels } from './stochastic'
import type { StochasticRecipe } from './stochastic-recipe'
import { part, told, type Work } from './work'

export interface Making {
  /** Ends it. */
  signal: AbortSignal
  /** Hears how much is done, 0 to 1. */
  tell: (share: number) => void
}

interface Made {
  design: Design
  map: LoadedMap
}

/** A foil of strewn shapes. */
export async function makeStrewn(recipe: StochasticRecipe, making: Making): Promise<Made> {
  const { height, tile_mm } = recipe
  const facts = { height, tile: [tile_mm, tile_mm] as const, recipe: { ...recipe } }
  const { foil, map } = await made(stochasticTexels(recipe), facts, making)
  return { map, design: { recipe, edited: null, foil, facts } }
}

/** A foil with periods by orientation. recipe: of the source, where its shapes were strewn here; name: of it then. */
export async function makeEdited(
  {
    source,
    recipe,
    name,
    edit,
  }: { source: LoadedMap; recipe: StochasticRecipe | null; name: string; edit: PeriodEdit },
  making: Making,
): Promise<Made> {
  const nameOfSource = recipe === null ? source.url.slice(source.url.lastIndexOf('/') + 1) : name
  const facts = editedFacts(source, nameOfSource, edit)
  const { foil, map } = await made(withPeriods(source, edit), facts, making)
  return { map, design: { recipe, edited: { edit, source }, foil, facts } }
}

async function made(
  work: Work<FoilTexels>,
  facts: FoilFacts,
  { signal, tell }: Making,
): Promise<{ foil: StoredFoil; map: LoadedMap }> {
  const foil = await bitByBit(
    told(texelsThenStored(work), (share) => {
      signal.throwIfAborted()
      tell(share)
    }),
  )
  const { map } = await madeFoil('design', foil, facts)
  signal.throwIfAborted()
  // It can be fetched from nowhere.
  return { foil, map: { ...map, url: '' } }
}

/** The rest is done by what is looked at, compressed and drawn of it. */
function* texelsThenStored(work: Work<FoilTexels>): Work<StoredFoil> {
  const texels = yield* part(0, 0.7, work)
  return yield* part(0.7, 0.8, stored(texels))
}
