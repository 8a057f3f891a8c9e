import { make, uniqueId } from '../../ui/elements'

/** A section with one picture, whose caption says in numbers what it shows and so is its text alternative. */
export class Block {
  readonly element = make('details', 'group block')
  readonly #caption = make('figcaption', '')

  constructor(title: string, isOpen: boolean, picture: Element, ...more: Element[]) {
    this.#caption.id = uniqueId()
    picture.setAttribute('aria-labelledby', this.#caption.id)
    if (!picture.hasAttribute('role')) picture.setAttribute('role', 'img')
    this.element.open = isOpen
    this.element.append(
      make('summary', '', title),
      make('figure', '', picture, ...more, this.#caption),
    )
  }

  /** Whether it would be seen if it were drawn. */
  get isOpen(): boolean {
    return this.element.open && !this.element.hidden
  }

  describe(text: string): void {
    if (this.#caption.textContent !== text) this.#caption.textContent = text
  }
}
