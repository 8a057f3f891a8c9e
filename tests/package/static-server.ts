import { readFile } from 'node:fs/promises'
import { createServer } from 'node:http'
import type { AddressInfo } from 'node:net'
import { extname, join } from 'node:path'

const TYPES: Record<string, string> = {
  '.bin': 'application/octet-stream',
  '.css': 'text/css',
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.json': 'application/json',
  '.png': 'image/png',
}

/** What is served in place of a file that is on disk, by its path from the server's root. */
export type Overrides = Record<string, string | undefined>

/**
 * Serves files as they are, on a free port.
 *
 * @param folders - of several files of one path the first folder's is served
 * @param headersOf - headers beside the type, for the contents of a file
 */
export async function serveFiles(
  folders: readonly string[],
  headersOf: (content: string) => Record<string, string> = () => ({}),
  overrides: Overrides = {},
): Promise<{ url: string; close: () => Promise<void> }> {
  const contentOf = async (path: string): Promise<Buffer | null> => {
    const override = overrides[path]
    if (override !== undefined) return Buffer.from(override)
    for (const folder of folders) {
      const content = await readFile(join(folder, path)).catch(() => null)
      if (content !== null) return content
    }
    return null
  }
  const server = createServer((request, response) => {
    const { pathname } = new URL(request.url ?? '/', 'http://localhost')
    const path = decodeURIComponent(pathname.endsWith('/') ? `${pathname}index.html` : pathname)
    // Browsers ask for it unasked.
    if (path === '/favicon.ico') return response.writeHead(204).end()
    return void contentOf(path).then((content) => {
      if (content === null) return response.writeHead(404).end()
      const type = TYPES[extname(path)] ?? 'application/octet-stream'
      const headers = type === 'text/html' ? headersOf(content.toString()) : {}
      return response.writeHead(200, { 'content-type': type, ...headers }).end(content)
    })
  })
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve))
  const { port } = server.address() as AddressInfo
  return {
    url: `http://127.0.0.1:${port}/`,
    close: () =>
      new Promise((resolve) => {
        server.close(() => {
          resolve()
        })
        server.closeAllConnections()
      }),
  }
}
