import { numberSetting, type Setting } from '../link/setting'
import type { Attempt, Control } from './control'
import { make, uniqueId } from './elements'

export interface SliderOptions {
  /** In the page's address. */
  name: string
  label: string
  unit: string
  min: number
  max: number
  step: number
  /** Undefined where there is nothing to set. */
  get: () => number | undefined
  set: (value: number) => void
}

/** A slider with its value and unit beside the label. */
export function slider(options: SliderOptions, attempt: Attempt): Control & { setting: Setting } {
  const { min, max, step, unit } = options
  const id = uniqueId()
  const input = make('input', '')
  Object.assign(input, { type: 'range', id, min, max, step })
  const output = make('output', '')
  output.htmlFor.add(id)
  const label = make('label', '', options.label)
  label.htmlFor = id
  const element = make('div', 'control', label, output, input)
  const digits = String(step).split('.')[1]?.length ?? 0

  const refresh = (): void => {
    const value = options.get()
    element.hidden = value === undefined
    if (value === undefined) return
    input.value = String(value)
    // A true minus sign is as wide as a digit, so that the number does not shift.
    const number = value.toFixed(digits).replace('-', '−')
    const separator = unit === '°' || unit === '' ? '' : '\u202f'
    output.textContent = number + separator + unit
    input.setAttribute('aria-valuetext', `${number} ${unit}`)
    input.style.setProperty('--share', String((value - min) / (max - min)))
  }
  input.addEventListener('input', () => {
    attempt(() => {
      options.set(input.valueAsNumber)
    })
    refresh()
  })
  return { element, refresh, setting: numberSetting(options.name, options) }
}
