/** `npm run format`: puts TypeScript, JavaScript, CSS, HTML and Python into the layout that `npm test` checks. */
import { join } from 'node:path'

import { installedFile, main, root, run, SetupError } from './process.mjs'
import { venvProgram } from './python.mjs'
import { ensureNodePackages, ensurePython } from './setup.mjs'

await main(async () => {
  await ensureNodePackages()
  await ensurePython()
  const web = await run(process.execPath, [
    installedFile('prettier/bin/prettier.cjs'),
    '--write',
    '.',
  ])
  const python = await run(join(root, venvProgram('ruff')), ['format', '.'])
  if (!web || !python) throw new SetupError('A file cannot be formatted: see above')
})
