/** `npm run build`: the npm package, modules and declarations, in dist/, beside the maps that it ships. */
import { buildPackage } from './package.mjs'
import { main } from './process.mjs'
import { ensureMaps, ensureNodePackages, ensurePython } from './setup.mjs'

await main(async () => {
  await ensureNodePackages()
  await ensurePython()
  await ensureMaps()
  await buildPackage()
})
