import type { Attempt, Control } from './control'
import { make, uniqueId } from './elements'

export interface ChoiceOptions<T extends string> {
  label: string
  /** Values and what they are called. */
  options: Readonly<Record<T, string>>
  /** Those that can be chosen now; all by default. */
  offered?: () => readonly T[]
  /** Undefined where there is nothing to choose. */
  get: () => T | undefined
  set: (value: T) => void
}

/** A drop-down list. */
export function choice<T extends string>(options: ChoiceOptions<T>, attempt: Attempt): Control {
  const id = uniqueId()
  const all = Object.keys(options.options) as T[]
  const select = make('select', '')
  select.id = id
  const label = make('label', '', options.label)
  label.htmlFor = id
  const element = make('div', 'control choice', label, select)

  let values: readonly T[] = []
  const offer = (offered: readonly T[]): void => {
    // An open list closes when it is filled anew.
    if (offered.join() === values.join()) return
    values = offered
    select.replaceChildren(...values.map((value) => new Option(options.options[value], value)))
  }
  const refresh = (): void => {
    const value = options.get()
    element.hidden = value === undefined
    if (value === undefined) return
    offer(options.offered?.() ?? all)
    select.value = value
  }
  select.addEventListener('change', () => {
    attempt(() => {
      options.set(values[select.selectedIndex]!)
    })
    refresh()
  })
  return { element, refresh }
}
