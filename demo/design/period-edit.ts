import type { LoadedMap } from '../../web/maps/load'
import type { Steps } from '../../web/steps'
import { factsOf, texelsOf, type FoilFacts, type FoilTexels } from './foil-map'

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
export function* withPeriods(map: LoadedMap, edit: PeriodEdit): Steps<FoilTexels> {
  const texels = yield* texelsOf(map)
  const { values, columns } = texels
  for (let i = 0; i < values.length; i += 4) {
    values[i + 2] = 1 / periodAt(edit, Math.atan2(values[i + 1]!, values[i]!) / 2)
    if (i % (4 * columns) === 0) yield
  }
  return texels
}

/** What an edited foil keeps, and a recipe that tells the edit after those that the foil has had. */
export function editedFacts(map: LoadedMap, edit: PeriodEdit): FoilFacts {
  const { recipe: before } = map.sidecar
  const isEdited = before['design'] === 'edited' && Array.isArray(before['edits'])
  const name = map.url.slice(map.url.lastIndexOf('/') + 1)
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
