/** `npm run docs`: the API reference of both languages, as pages in docs/api/. */
import { pdocCommand } from './pdoc.mjs'
import { installedFile, main, runQuietly } from './process.mjs'
import { ensureNodePackages, ensurePython } from './setup.mjs'

await main(async () => {
  await ensureNodePackages()
  await ensurePython()
  await runQuietly('Documenting three-diffraction', process.execPath, [
    installedFile('typedoc/bin/typedoc'),
  ])
  const [pdoc, ...args] = pdocCommand('docs/api/precompute')
  await runQuietly('Documenting precompute', pdoc, args)
  console.log('docs/api/three-diffraction/index.html, docs/api/precompute/index.html')
})
