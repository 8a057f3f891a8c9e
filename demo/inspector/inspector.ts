import type { Demo } from '../demo'
import type { Tool } from '../tools/dock'
import { byId } from '../ui/elements'

/** The tool that shows what the picture is made of, at one point of the object on the stage. */
export class Inspector implements Tool {
  readonly button = byId('inspect', HTMLButtonElement)
  readonly title = 'Building blocks'

  constructor(private readonly demo: Demo) {}

  async load(): ReturnType<Tool['load']> {
    const { InspectorContents } = await import('./contents')
    return new InspectorContents(this.demo)
  }
}
