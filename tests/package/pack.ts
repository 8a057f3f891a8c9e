import { execFile } from 'node:child_process'
import { mkdir, readdir, rm, writeFile } from 'node:fs/promises'
import { join, relative } from 'node:path'
import { fileURLToPath } from 'node:url'
import { promisify } from 'node:util'
import { runNpm } from '../../scripts/node-packages.mjs'
import { buildPackage } from '../../scripts/package.mjs'

export const root = fileURLToPath(new URL('../../', import.meta.url))
/** A project that has installed the package. Inside the repository: three is found above it. */
export const consumer = join(root, 'tests', 'output', 'package')
export const installed = join(consumer, 'node_modules', 'three-diffraction')

/** Builds the package, packs it, and unpacks it where the consumer would have it, once for all tests. */
export default async function pack(): Promise<void> {
  await rm(consumer, { recursive: true, force: true })
  await mkdir(installed, { recursive: true })
  await writeFile(join(consumer, 'package.json'), '{ "name": "consumer", "type": "module" }')
  await buildPackage()
  await runNpm('Packing', ['pack', '--ignore-scripts', '--pack-destination', consumer])
  const options = ['-xzf', await tarballName(), '--strip-components=1', '-C']
  await promisify(execFile)('tar', [...options, relative(consumer, installed)], { cwd: consumer })
}

export async function tarballName(): Promise<string> {
  return (await readdir(consumer)).find((file) => file.endsWith('.tgz'))!
}
