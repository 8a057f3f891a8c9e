import type { Demo } from '../demo'
import { byId } from './elements'

/** Says what is on show, and what had to be put right in the environment. */
export function showStatus({ subject, surroundings }: Demo): void {
  const { loaded } = surroundings
  const text =
    loaded === null
      ? 'No environment: the flash alone lights the scene.'
      : `Environment: ${loaded.repaired} of ${loaded.channels} numbers were negative and are set to zero.`
  write('caption', subject.caption)
  write('status', text)
}

/** What is read out when it changes must not be written when it does not. */
function write(id: string, text: string): void {
  const element = byId(id, HTMLParagraphElement)
  if (element.textContent !== text) element.textContent = text
}
