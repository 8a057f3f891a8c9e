import type { Demo } from '../demo'
import { byId } from '../ui/elements'
import type { Tool } from './dock'

/** The page's tools. */
export function tools(demo: Demo): Tool[] {
  return [
    {
      button: byId('inspect', HTMLButtonElement),
      title: 'Building blocks',
      load: async () => {
        const { InspectorContents } = await import('../inspector/contents')
        return new InspectorContents(demo)
      },
    },
    {
      button: byId('design', HTMLButtonElement),
      title: 'Design a foil',
      load: async () => {
        const { DesignContents } = await import('../design/contents')
        return new DesignContents(demo)
      },
    },
  ]
}
