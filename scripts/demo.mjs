/**
 * `npm run demo`: sets up what is missing, then serves the demo page. `npm run demo -- --port 8080 --host 0.0.0.0`
 * serves it elsewhere.
 */
import { join } from 'node:path'
import { parseArgs } from 'node:util'

import { elapsed, main, refuse, root, SetupError } from './process.mjs'
import { ensureMaps, ensureNodePackages, ensurePython } from './setup.mjs'

function options() {
  try {
    return parseArgs({ options: { port: { type: 'string' }, host: { type: 'string' } } }).values
  } catch (error) {
    return refuse(error)
  }
}

/** Where to serve, as the command line says. */
function address() {
  const { port: wanted, host } = options()
  const port = Number(wanted ?? 5173)
  if (!Number.isInteger(port) || port < 1 || port > 65535) {
    throw new SetupError(`--port ${wanted}: a whole number from 1 to 65535 is expected`)
  }
  // A port that was asked for is taken or refused; the usual one may be in use, then the next free one does.
  return { port, strictPort: wanted !== undefined, ...(host && { host }) }
}

await main(async () => {
  const start = performance.now()
  const server = address()
  await ensureNodePackages()
  await ensurePython()
  await ensureMaps()
  console.log(`Set up in ${elapsed(start)}`)
  const { createServer } = await import('vite')
  const demo = await createServer({ configFile: join(root, 'vite.config.ts'), server })
  await demo.listen().catch(refuse)
  demo.printUrls()
})
