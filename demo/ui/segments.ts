import type { Control } from './control'
import { make, uniqueId } from './elements'

export interface SegmentOptions<T extends string> {
  options: Readonly<Record<T, string>>
  get: () => T
  set: (value: T) => void
}

/** Fills a fieldset with radio buttons that look like one bar. */
export function segments<T extends string>(
  fieldset: HTMLFieldSetElement,
  { options, get, set }: SegmentOptions<T>,
): Control {
  const name = uniqueId()
  const inputs = (Object.keys(options) as T[]).map((value) => {
    const input = make('input', '')
    Object.assign(input, { type: 'radio', name, value })
    input.addEventListener('change', () => {
      set(value)
    })
    fieldset.append(make('label', '', input, make('span', '', options[value])))
    return input
  })
  const refresh = (): void => {
    for (const input of inputs) {
      input.checked = input.value === get()
      // In a narrow window the bar scrolls.
      if (input.checked)
        input.parentElement?.scrollIntoView({ block: 'nearest', inline: 'nearest' })
    }
  }
  refresh()
  return { element: fieldset, refresh }
}
