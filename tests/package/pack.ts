import { execFile } from 'node:child_process'
import { mkdir, readdir, rename, rm, writeFile } from 'node:fs/promises'
import { join, relative } from 'node:path'
import { fileURLToPath } from 'node:url'
import { promisify } from 'node:util'
import { runNpm } from '../../scripts/node-packages.mjs'
import { buildPackage } from '../../scripts/package.mjs'

export const root = fileURLToPath(new URL('../../', import.meta.url))
/** Inside the repository: three and its declarations are found above it, as beside a package that is installed. */
export const consumer = join(root, 'tests', 'output', 'package')
export const installed = join(consumer, 'node_modules', 'three-diffraction')
export const tarball = join(consumer, 'three-diffraction.tgz')

/** Builds and packs the package and installs it in `consumer`: once, before all tests of the package. */
export default async function setup(): Promise<void> {
  await rm(consumer, { recursive: true, force: true })
  await mkdir(installed, { recursive: true })
  await writeFile(join(consumer, 'package.json'), '{ "name": "consumer", "type": "module" }')
  // Without one bundlers would read the repository's, by which the package is its source.
  await writeFile(join(consumer, 'tsconfig.json'), '{ "compilerOptions": { "jsx": "react-jsx" } }')
  await buildPackage()
  await runNpm('Packing', ['pack', '--ignore-scripts', '--pack-destination', consumer])
  const name = (await readdir(consumer)).find((file) => file.endsWith('.tgz'))!
  await rename(join(consumer, name), tarball)
  const options = ['--strip-components=1', '-C', relative(consumer, installed)]
  await promisify(execFile)('tar', ['-xzf', relative(consumer, tarball), ...options], {
    cwd: consumer,
  })
}
