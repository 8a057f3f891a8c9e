import { disc } from './disc'
import { foilCard } from './foil-card'
import { sample } from './sample'
import { snake } from './snake/snake'
import type { Subject } from './subject'
import { vase } from './vase'

/** What there is to look at; each is made when it is first chosen. */
export const SUBJECTS = {
  foil: 'Foil',
  disc: 'Disc',
  vase: 'Vase',
  snake: 'Snake',
  sample: 'Sample',
} as const
export type SubjectName = keyof typeof SUBJECTS

const makers: Record<SubjectName, () => Promise<Subject>> = {
  foil: foilCard,
  disc,
  vase,
  snake,
  sample,
}
const made = new Map<SubjectName, Promise<Subject>>()

export function loadSubject(name: SubjectName): Promise<Subject> {
  const known = made.get(name)
  if (known !== undefined) return known
  const making = makers[name]()
  made.set(name, making)
  making.catch(() => made.delete(name))
  return making
}

export function isSubjectName(name: string | null): name is SubjectName {
  return name !== null && name in SUBJECTS
}
