import type { Comparison } from '../compare/comparison'
import { byId } from './elements'

/** The line between both methods: a slider as wide as the view, so that it is dragged, and moved by keys, as one. */
export function divider(comparison: Comparison): { refresh: () => void } {
  const input = byId('divider', HTMLInputElement)
  const refresh = (): void => {
    input.hidden = !comparison.isOn
    input.valueAsNumber = 100 * comparison.line
    input.style.setProperty('--share', String(comparison.line))
  }
  input.addEventListener('input', () => {
    comparison.line = input.valueAsNumber / 100
    refresh()
  })
  return { refresh }
}
