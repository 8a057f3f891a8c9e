import { renameSync, rmSync } from 'node:fs'
import { join } from 'node:path'

import { elapsed, root, run, SetupError } from './process.mjs'
import { venvProgram } from './python.mjs'
import { buildWhenStale, contentHash, filesUnder } from './stamp.mjs'

/** Bakes every recipe into maps/baked/. */
export async function ensureMaps() {
  const inputs = contentHash([
    'requirements.txt',
    ...filesUnder('precompute'),
    ...filesUnder('maps/recipes'),
  ])
  const outputs = () => filesUnder('maps/baked')
  await buildWhenStale('maps', inputs, outputs, async () => {
    const recipes = filesUnder('maps/recipes').filter((file) => file.endsWith('.json'))
    if (recipes.length === 0) throw new SetupError('No recipe in maps/recipes/')
    const start = performance.now()
    console.log(`Baking ${recipes.length} maps …`)
    // Aside, then in one step: a page that is open keeps its maps, and what an earlier recipe left does not stay.
    const aside = join(root, 'maps', 'baking')
    rmSync(aside, { recursive: true, force: true })
    const program = join(root, venvProgram('diffraction'))
    if (!(await run(program, ['bake', '--output', 'maps/baking', ...recipes]))) {
      throw new SetupError('Baking the maps failed: see above')
    }
    rmSync(join(root, 'maps', 'baked'), { recursive: true, force: true })
    renameSync(aside, join(root, 'maps', 'baked'))
    console.log(`  done in ${elapsed(start)}`)
  })
}
