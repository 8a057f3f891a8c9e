import { byId } from './elements'

/** What went wrong, in the library's own words, until it is closed or put right. */
export class Banner {
  readonly #element = byId('banner', HTMLDivElement)
  readonly #text = byId('banner-text', HTMLParagraphElement)

  constructor() {
    byId('banner-close', HTMLButtonElement).addEventListener('click', () => {
      this.hide()
    })
  }

  show(error: unknown): void {
    this.#text.textContent = error instanceof Error ? error.message : String(error)
    this.#element.hidden = false
  }

  hide(): void {
    this.#element.hidden = true
  }
}
