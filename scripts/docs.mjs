/** `npm run docs`: the API reference of both languages, as pages in docs/api/. */
import { join } from 'node:path'

import { installedFile, main, root, runQuietly } from './process.mjs'
import { venvProgram } from './python.mjs'
import { ensureNodePackages, ensurePython } from './setup.mjs'

await main(async () => {
  await ensureNodePackages()
  await ensurePython()
  await runQuietly('Documenting three-diffraction', process.execPath, [
    installedFile('typedoc/bin/typedoc'),
  ])
  await runQuietly('Documenting precompute', join(root, venvProgram('pdoc')), [
    ...['--docformat', 'google', '--no-show-source'],
    ...['--output-directory', 'docs/api/precompute'],
    'precompute',
    // What the command line is and the report's drawings are no interface.
    '!precompute.cli',
    '!precompute.report',
  ])
  console.log('docs/api/three-diffraction/index.html, docs/api/precompute/index.html')
})
