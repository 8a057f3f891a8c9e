import { installedFile, runQuietly } from './process.mjs'

/** Fills dist/ with the npm package's modules, their source maps and their declarations. */
export async function buildPackage() {
  const vite = [installedFile('vite/bin/vite.js'), 'build', '--config', 'vite.lib.config.ts']
  await runQuietly('Building the modules', process.execPath, vite)
  const tsc = [installedFile('typescript/bin/tsc'), '--project', 'tsconfig.build.json']
  await runQuietly('Building their declarations', process.execPath, tsc)
}
