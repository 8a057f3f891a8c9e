import { rmSync } from 'node:fs'
import { join } from 'node:path'

import { elapsed, root, run, SetupError } from './process.mjs'
import { venvProgram } from './python.mjs'
import { buildWhenStale, contentHash, filesUnder } from './stamp.mjs'

/** Bakes every recipe into maps/baked/. */
export async function ensureMaps() {
  const inputs = contentHash([
    'requirements.txt',
    ...filesUnder('precompute'),
    ...filesUnder('maps').filter((file) => !file.startsWith('maps/baked/')),
  ])
  const outputs = () => filesUnder('maps/baked')
  await buildWhenStale('maps', inputs, outputs, async () => {
    const recipes = filesUnder('maps/recipes').filter((file) => file.endsWith('.json'))
    if (recipes.length === 0) throw new SetupError('No recipe in maps/recipes/')
    const start = performance.now()
    console.log(`Baking ${recipes.length} maps …`)
    // What an earlier recipe left must not pass for a map of this one.
    rmSync(join(root, 'maps', 'baked'), { recursive: true, force: true })
    if (!(await run(join(root, venvProgram('diffraction')), ['bake', ...recipes]))) {
      throw new SetupError('Baking the maps failed: see above')
    }
    console.log(`  done in ${elapsed(start)}`)
  })
}
