import { choiceSetting, type Setting } from '../link/setting'
import type { Attempt, Control } from './control'
import { make, uniqueId } from './elements'

export interface ChoiceOptions<T extends string> {
  /** In the page's address. */
  name: string
  label: string
  /** Values and what they are called. */
  options: Readonly<Record<T, string>>
  /** Those that can be chosen now; all by default. */
  offered?: () => readonly T[]
  /** Undefined where there is nothing to choose. */
  get: () => T | undefined
  set: (value: T) => void | Promise<void>
}

/** A drop-down list. */
export function choice<T extends string>(
  options: ChoiceOptions<T>,
  attempt: Attempt,
): Control & { setting: Setting } {
  const id = uniqueId()
  const words = options.offered ?? ((): readonly T[] => Object.keys(options.options) as T[])
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
    offer(words())
    select.value = value
  }
  select.addEventListener('change', () => {
    attempt(() => {
      // What takes time says itself how it went.
      void options.set(values[select.selectedIndex]!)
    })
    refresh()
  })
  const { name, get, set } = options
  return { element, refresh, setting: choiceSetting(name, { words, get, set }) }
}
