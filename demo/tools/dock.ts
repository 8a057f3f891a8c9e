import { byId, make } from '../ui/elements'

/** What a tool shows once it is loaded. */
export interface ToolContents {
  element: HTMLElement
  /** Called when it comes into view, and when it leaves it. */
  open: () => void
  close: () => void
  /** Called when values of the page have changed while it is in view. */
  refresh?: () => void
}

export interface Tool {
  button: HTMLButtonElement
  title: string
  /** Fetches code and makes the contents, when the tool is first opened. */
  load: () => Promise<ToolContents>
}

/** The place beside the view where one of the page's tools is open, or none. */
export class Dock {
  readonly #element = byId('dock', HTMLElement)
  readonly #title = make('h2', '')
  readonly #body = make('div', 'dock-body')
  readonly #contents = new Map<Tool, Promise<ToolContents>>()
  #open: Tool | null = null
  #shown: ToolContents | null = null

  /** @param onError - told of a tool that could not be loaded */
  constructor(private readonly onError: (error: unknown) => void) {
    const close = make('button', '', '×')
    Object.assign(close, { type: 'button', ariaLabel: 'Close' })
    close.addEventListener('click', () => void this.show(null))
    this.#element.append(make('header', 'dock-head', this.#title, close), this.#body)
    document.addEventListener('keydown', (event) => {
      if (event.key === 'Escape' && !event.defaultPrevented) void this.show(null)
    })
    // On a phone there is room for one of the two.
    const sheet = byId('sheet', HTMLDetailsElement)
    sheet.addEventListener('toggle', () => {
      if (sheet.open && isNarrow()) void this.show(null)
    })
  }

  add(tool: Tool): void {
    const { button } = tool
    button.setAttribute('aria-expanded', 'false')
    button.setAttribute('aria-controls', this.#element.id)
    button.addEventListener('click', () => void this.show(this.#open === tool ? null : tool))
  }

  refresh(): void {
    this.#shown?.refresh?.()
  }

  async show(tool: Tool | null): Promise<void> {
    const before = this.#open
    if (before === tool) return
    this.#open = tool
    this.#shown = null
    if (before !== null) {
      before.button.setAttribute('aria-expanded', 'false')
      const contents = await this.#contents.get(before)
      contents?.close()
      if (this.#element.contains(document.activeElement)) before.button.focus()
    }
    if (this.#open !== tool) return
    this.#element.hidden = tool === null
    if (tool === null) return
    if (isNarrow()) byId('sheet', HTMLDetailsElement).open = false
    tool.button.setAttribute('aria-expanded', 'true')
    this.#title.textContent = tool.title
    this.#body.replaceChildren(make('p', 'note', 'Loading …'))
    await this.#fill(tool)
  }

  async #fill(tool: Tool): Promise<void> {
    let loading = this.#contents.get(tool)
    if (loading === undefined) {
      loading = tool.load()
      this.#contents.set(tool, loading)
    }
    try {
      const contents = await loading
      if (this.#open !== tool) return
      this.#body.replaceChildren(contents.element)
      contents.open()
      this.#shown = contents
    } catch (error) {
      this.#contents.delete(tool)
      this.onError(error)
      if (this.#open === tool) await this.show(null)
    }
  }
}

function isNarrow(): boolean {
  return !matchMedia('(min-width: 820px)').matches
}
