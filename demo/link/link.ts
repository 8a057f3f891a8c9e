import type { Setting } from './setting'

/** The page's address with all settings as they are: whoever opens it sees the same. */
export function linkTo(page: string, settings: readonly Setting[]): string {
  const link = new URL(page)
  link.search = ''
  link.hash = ''
  for (const { name, read } of settings) {
    const value = read()
    if (value !== undefined) link.searchParams.set(name, value)
  }
  // All may stand in an address as they are, and are easier to read so.
  return link.href.replaceAll('%2C', ',').replaceAll('%2F', '/').replaceAll('%3A', ':')
}

/** Takes over what an address states, in the settings' order. What it states as it is already is left alone. */
export async function follow(
  parameters: URLSearchParams,
  settings: readonly Setting[],
): Promise<void> {
  for (const { name, read, write } of settings) {
    const text = parameters.get(name)
    if (text !== null && text !== read()) await write(text)
  }
}
