import type { Demo } from '../demo'
import type { Tool } from '../tools/dock'
import { byId } from '../ui/elements'

/** The tool by which foils are made in the page. */
export class DesignPanel implements Tool {
  readonly button = byId('design', HTMLButtonElement)
  readonly title = 'Design a foil'

  constructor(private readonly demo: Demo) {}

  async load(): ReturnType<Tool['load']> {
    const { DesignContents } = await import('./contents')
    return new DesignContents(this.demo)
  }
}
