import { readFile } from 'node:fs/promises'
import { fileURLToPath } from 'node:url'
import { vi } from 'vitest'

const root = new URL('../../', import.meta.url)

/** Answers fetches of addresses such as 'maps/baked/metals.json' from the files that the set-up baked. */
export function serveBakedMaps(): void {
  vi.stubGlobal('fetch', async (address: string): Promise<Response> => {
    const data = await readFile(fileURLToPath(new URL(address, root)))
    return new Response(new Uint8Array(data))
  })
}
