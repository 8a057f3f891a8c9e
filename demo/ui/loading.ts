import { byId } from './elements'

/** The bar over the picture while something is fetched or made. */
export class Loading {
  readonly #element = byId('loading', HTMLDivElement)
  readonly #text = byId('loading-text', HTMLLabelElement)
  readonly #progress = byId('progress', HTMLProgressElement)
  /** The tasks since there was none, each with how much of it is done. */
  readonly #tasks: { share: number; isDone: boolean }[] = []

  /**
   * Counts a task in until it settles.
   *
   * @param text - that says what is being done
   * @param task - may tell how much of it is done, 0 to 1
   */
  async track<T>(text: string, task: (tell: (share: number) => void) => Promise<T>): Promise<T> {
    const own = { share: 0, isDone: false }
    this.#tasks.push(own)
    this.#text.textContent = text
    this.#refresh()
    try {
      return await task((share) => {
        own.share = share
        this.#refresh()
      })
    } finally {
      Object.assign(own, { share: 1, isDone: true })
      this.#refresh()
    }
  }

  #refresh(): void {
    if (this.#tasks.every(({ isDone }) => isDone)) this.#tasks.length = 0
    const count = this.#tasks.length
    this.#element.hidden = count === 0
    // A task under way counts for a part, so that the bar is seen from the start.
    const done = this.#tasks.reduce((sum, { share }) => sum + share, 0)
    this.#progress.value = (done + 0.25) / (count + 0.25)
  }
}
