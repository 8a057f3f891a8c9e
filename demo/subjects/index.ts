import { bag } from './bag'
import { bottle } from './bottle'
import { card } from './card'
import { disc } from './disc'
import { note } from './note/note'
import { snake } from './snake/snake'
import type { Subject } from './subject'
import { vase } from './vase'
import { wafer } from './wafer'

/** What there is to look at; each is made when it is first chosen. */
export const SUBJECTS = {
  card: 'Card',
  bag: 'Bag',
  note: 'Note',
  bottle: 'Bottle',
  disc: 'Disc',
  vase: 'Vase',
  snake: 'Snake',
  wafer: 'Wafer',
} as const
export type SubjectName = keyof typeof SUBJECTS

const makers: Record<SubjectName, () => Promise<Subject>> = {
  card,
  bag,
  note,
  bottle,
  disc,
  vase,
  snake,
  wafer,
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
