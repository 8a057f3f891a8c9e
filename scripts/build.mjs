/** `npm run build`: the npm package, modules and declarations, in dist/, beside the maps that it ships. */
import { installedFile, main, run, SetupError } from './process.mjs'
import { ensureMaps, ensureNodePackages, ensurePython } from './setup.mjs'

await main(async () => {
  await ensureNodePackages()
  await ensurePython()
  await ensureMaps()
  const commands = [
    [installedFile('vite/bin/vite.js'), 'build', '--config', 'vite.lib.config.ts'],
    [installedFile('typescript/bin/tsc'), '--project', 'tsconfig.build.json'],
  ]
  for (const command of commands) {
    if (!(await run(process.execPath, command)))
      throw new SetupError('The build has failed: see above')
  }
})
