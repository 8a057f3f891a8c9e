import { byId } from './elements'

/** How long a note stays, ms. */
const NOTE_TIME = 4000

/** What went wrong, in the library's own words, until it is closed or put right; or a short note of what went well. */
export class Banner {
  readonly #element = byId('banner', HTMLDivElement)
  readonly #text = byId('banner-text', HTMLParagraphElement)
  #timer = 0

  constructor() {
    byId('banner-close', HTMLButtonElement).addEventListener('click', () => {
      this.hide()
    })
  }

  show(error: unknown): void {
    this.#say(error instanceof Error ? error.message : String(error), false)
  }

  note(text: string): void {
    this.#say(text, true)
    this.#timer = window.setTimeout(() => {
      this.hide()
    }, NOTE_TIME)
  }

  hide(): void {
    window.clearTimeout(this.#timer)
    this.#element.hidden = true
  }

  #say(text: string, isNote: boolean): void {
    window.clearTimeout(this.#timer)
    this.#text.textContent = text
    this.#element.classList.toggle('note', isNote)
    this.#element.hidden = false
  }
}
