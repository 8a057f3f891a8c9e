import { byId } from './elements'

/** The bar over the picture while something is fetched. */
export class Loading {
  readonly #element = byId('loading', HTMLDivElement)
  readonly #text = byId('loading-text', HTMLLabelElement)
  readonly #progress = byId('progress', HTMLProgressElement)
  #started = 0
  #done = 0

  /** Counts a task in until it settles. */
  async track<T>(what: string, task: Promise<T>): Promise<T> {
    this.#started++
    this.#text.textContent = `Loading ${what} …`
    this.#refresh()
    try {
      return await task
    } finally {
      this.#done++
      this.#refresh()
    }
  }

  #refresh(): void {
    const isDone = this.#done === this.#started
    if (isDone) this.#started = this.#done = 0
    this.#element.hidden = isDone
    // A task under way counts for a part, so that the bar is seen from the start.
    this.#progress.value = (this.#done + 0.25) / (this.#started + 0.25)
  }
}
