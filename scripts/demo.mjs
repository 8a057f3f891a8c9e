/**
 * `npm run demo`: sets up what is missing, builds the demo page and serves it. `npm run demo -- --port 8080 --host 0.0.0.0`
 * serves it elsewhere, `npm run demo -- --dev` as it is in the sources, each change shown at once.
 */
import { join } from 'node:path'
import { parseArgs } from 'node:util'

import { elapsed, main, refuse, root, SetupError } from './process.mjs'
import { ensureDemoPage, ensureMaps, ensureNodePackages, ensurePython } from './setup.mjs'

function options() {
  try {
    return parseArgs({
      options: { port: { type: 'string' }, host: { type: 'string' }, dev: { type: 'boolean' } },
    }).values
  } catch (error) {
    return refuse(error)
  }
}

/**
 * Where to serve, as the command line says.
 *
 * @param {{ port?: string, host?: string }} options
 */
function address({ port: wanted, host }) {
  const port = Number(wanted ?? 5173)
  if (!Number.isInteger(port) || port < 1 || port > 65535) {
    throw new SetupError(`--port ${wanted}: a whole number from 1 to 65535 is expected`)
  }
  // A port that was asked for is taken or refused; the usual one may be in use, then the next free one does.
  return { port, strictPort: wanted !== undefined, ...(host && { host }) }
}

await main(async () => {
  const start = performance.now()
  const chosen = options()
  const server = address(chosen)
  await ensureNodePackages()
  await ensurePython()
  await ensureMaps()
  if (!chosen.dev) await ensureDemoPage()
  console.log(`Set up in ${elapsed(start)}`)
  const { createServer, preview } = await import('vite')
  const configFile = join(root, 'vite.config.ts')
  if (chosen.dev) {
    const demo = await createServer({ configFile, server })
    await demo.listen().catch(refuse)
    demo.printUrls()
  } else {
    const demo = await preview({ configFile, preview: server }).catch(refuse)
    demo.printUrls()
  }
})
