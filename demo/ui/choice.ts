import type { Attempt, Control } from './control'
import { make, uniqueId } from './elements'

export interface ChoiceOptions<T extends string> {
  label: string
  /** Values and what they are called. */
  options: Readonly<Record<T, string>>
  get: () => T
  set: (value: T) => void
}

/** A drop-down list. */
export function choice<T extends string>(options: ChoiceOptions<T>, attempt: Attempt): Control {
  const id = uniqueId()
  const values = Object.keys(options.options) as T[]
  const select = make('select', '')
  select.id = id
  for (const value of values) select.add(new Option(options.options[value], value))
  const label = make('label', '', options.label)
  label.htmlFor = id
  const element = make('div', 'control choice', label, select)

  const refresh = (): void => {
    select.value = options.get()
  }
  select.addEventListener('change', () => {
    attempt(() => {
      options.set(values[select.selectedIndex]!)
    })
    refresh()
  })
  return { element, refresh }
}
