import type { Feature } from '../../web'
import { make } from './elements'

/** What is in the shader, what is left out, and why; filled when it is opened. */
export class Explanation {
  readonly element = make('details', 'group')
  readonly #list = make('ul', 'explanation')

  constructor(private readonly explain: () => Feature[]) {
    this.element.append(make('summary', '', 'What is in the shader'), this.#list)
    this.element.addEventListener('toggle', () => {
      this.refresh()
    })
  }

  refresh(): void {
    if (this.element.open) this.#list.replaceChildren(...this.explain().map(entry))
  }
}

function entry({ feature, included, why }: Feature): HTMLLIElement {
  const state = included ? 'in' : 'out'
  const line = make(
    'li',
    state,
    make('b', '', feature),
    make('i', '', state),
    make('span', '', why),
  )
  return line
}
