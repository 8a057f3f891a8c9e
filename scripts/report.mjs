/** `npm run report`: sets up what is missing, then measures error against run time in Chromium. */
import { join } from 'node:path'

import { main, root, run, SetupError } from './process.mjs'
import { venvProgram } from './python.mjs'
import { ensureBrowser, ensureMaps, ensureNodePackages, ensurePython } from './setup.mjs'

await main(async () => {
  await ensureNodePackages()
  await ensurePython()
  await ensureMaps()
  await ensureBrowser()
  const diffraction = join(root, venvProgram('diffraction'))
  if (!(await run(diffraction, ['report', ...process.argv.slice(2)]))) {
    throw new SetupError('The report has failed: see above')
  }
})
