import type { LoadedMap } from '../../web/maps/load'
import { factsOf, texelsOf, type FoilFacts, type FoilTexels } from './foil-map'
import { readNumber, readWord, refusal, type NumberRange, type Texts } from './values'
import { part, type Work } from './work'

export const BLENDS = { linear: 'Linear', quadratic: 'Quadratic', sin2: 'Sine squared' } as const
export type Blend = keyof typeof BLENDS

/** Period by orientation, as `diffraction edit` has it (the 2018 paper, section 6.4). */
export interface PeriodEdit {
  kind: 'period'
  /** Period of the first bin, orientation 0, µm. */
  shortest: number
  /** Of the last, one bin short of 180°, µm. */
  longest: number
  /** Of orientation, equally wide, the first about 0. */
  bins: number
  /** From first to last bin, t being 0 to 1: t, t² or sin²(πt/2). */
  blend: Blend
}

/** What the edit's numbers may be, by their names. */
export const EDIT_RANGES = {
  shortest: { unit: 'µm', min: 0.4, max: 20 },
  longest: { unit: 'µm', min: 0.4, max: 20 },
  bins: { unit: '', min: 2, max: 3600, isWhole: true },
} as const satisfies Record<string, NumberRange>

/** The edit that texts state; throws a DiffractionError that names the one that cannot be used. */
export function readEdit(texts: Texts): PeriodEdit {
  const read = (name: keyof typeof EDIT_RANGES): number =>
    readNumber(name, texts[name], EDIT_RANGES[name])
  const [shortest, longest] = [read('shortest'), read('longest')]
  if (longest < shortest)
    throw refusal('longest', longest, `the period at 0°, ${shortest} µm, or more`)
  const blend = readWord('blend', texts['blend'], BLENDS)
  return { kind: 'period', shortest, longest, bins: read('bins'), blend }
}

/** The texts that state an edit. */
export function textsOfEdit({ shortest, longest, bins, blend }: PeriodEdit): Texts {
  return { shortest: String(shortest), longest: String(longest), bins: String(bins), blend }
}

const BLENDED: Record<Blend, (share: number) => number> = {
  linear: (share) => share,
  quadratic: (share) => share ** 2,
  sin2: (share) => Math.sin((Math.PI * share) / 2) ** 2,
}

/** The period of an orientation, rad, known modulo π; µm. */
export function periodAt(
  { shortest, longest, bins, blend }: PeriodEdit,
  orientation: number,
): number {
  // The nearest bin, not the next below: 8 bits put 15° at 14.9 as often as at 15.1.
  const bin = Math.round((orientation * bins) / Math.PI)
  const share = (((bin % bins) + bins) % bins) / (bins - 1)
  return shortest + (longest - shortest) * BLENDED[blend](share)
}

/** A foil with other periods, row by row; what the sidecar tells of it comes from `editedFacts`. */
export function* withPeriods(map: LoadedMap, edit: PeriodEdit): Work<FoilTexels> {
  const texels = yield* part(0, 0.3, texelsOf(map))
  const { values, columns } = texels
  for (let i = 0; i < values.length; i += 4) {
    if (i % (4 * columns) === 0) yield 0.3 + (0.7 * i) / values.length
    values[i + 2] = 1 / periodAt(edit, Math.atan2(values[i + 1]!, values[i]!) / 2)
  }
  return texels
}

/**
 * What an edited foil keeps, and a recipe that tells the edit after those that the foil has had.
 *
 * @param name - of the foil that is edited
 */
export function editedFacts(map: LoadedMap, name: string, edit: PeriodEdit): FoilFacts {
  const { recipe: before } = map.sidecar
  const isEdited = before['design'] === 'edited' && Array.isArray(before['edits'])
  const profile = before['profile']
  return {
    ...factsOf(map),
    recipe: {
      ...{ kind: 'foil', design: 'edited' },
      from: isEdited ? before['from'] : { map: name, recipe: before },
      edits: [...(isEdited ? (before['edits'] as unknown[]) : []), edit],
      ...(profile !== undefined && { profile }),
    },
  }
}
