import { execFile } from 'node:child_process'
import { mkdir, mkdtemp, rm, writeFile } from 'node:fs/promises'
import { join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { promisify } from 'node:util'
import { afterAll, afterEach, beforeAll, describe, expect, it, vi } from 'vitest'
import { venvProgram } from '../../scripts/python.mjs'
import { madeFoil, stored, type FoilTexels, type MadeFoil } from '../../demo/design/foil-map'
import { NumpyRandom } from '../../demo/design/numpy-random'
import { editedFacts, periodAt, withPeriods, type PeriodEdit } from '../../demo/design/period-edit'
import { stochasticTexels } from '../../demo/design/stochastic'
import type { StochasticRecipe } from '../../demo/design/stochastic-recipe'
import type { Work } from '../../demo/design/work'
import { Foil } from '../../web'
import { loadMap } from '../../web/maps/load'
import { serveBakedMaps } from './baked-maps'
import { serveFiles } from './fake-maps'
import { python } from './python'

const root = fileURLToPath(new URL('../../', import.meta.url))
// Python starts for each.
vi.setConfig({ testTimeout: 60_000 })

let folder: string

beforeAll(async () => {
  await mkdir(join(root, 'tests/output'), { recursive: true })
  folder = await mkdtemp(join(root, 'tests/output/design-'))
})

afterEach(() => {
  vi.unstubAllGlobals()
})

afterAll(async () => {
  await rm(folder, { recursive: true })
})

function recipe(values: Partial<StochasticRecipe>): StochasticRecipe {
  return {
    ...{ kind: 'foil', size: 96, tile_mm: 10, height: 0.15, profile: 'sinusoidal', seed: 7 },
    design: 'stochastic',
    distribution: { kind: 'spiral', shortest: 1.2, longest: 2.4, spread: 0.02 },
    ...{ shape: 'squares', mask: null, shape_mm: 0.8, cover: 3 },
    ...values,
  }
}

/** All of a work now. */
function atOnce<Result>(work: Work<Result>): Result {
  let step = work.next()
  while (!step.done) step = work.next()
  return step.value
}

async function written(
  name: string,
  texels: FoilTexels,
  facts: Parameters<typeof madeFoil>[2],
): Promise<MadeFoil> {
  const foil = await madeFoil(name, atOnce(stored(texels)), facts)
  for (const [file, bytes] of Object.entries(foil.files)) await writeFile(join(folder, file), bytes)
  return foil
}

/** The sidecar's fields that two makers of the same foil have in common. */
function common({ files, name }: MadeFoil): unknown {
  return fieldsInCommon(JSON.parse(new TextDecoder().decode(files[`${name}.json`])))
}

function fieldsInCommon(sidecar: unknown): unknown {
  const fields = structuredClone(sidecar) as Record<string, unknown> & {
    arrays: Record<string, Record<string, unknown>>
    error: Record<string, unknown>
  }
  delete fields['generator']
  for (const array of Object.values(fields.arrays)) {
    // Two PNG encoders need not write the same bytes.
    delete array['sha256']
    delete array['file']
  }
  fields.error['relative_rms'] = Number((fields.error['relative_rms'] as number).toPrecision(10))
  return fields
}

describe('random numbers', () => {
  it.each([0, 1, 7, 2 ** 32 + 5, 2 ** 53 - 1])('are numpy’s, seed %d', async (seed) => {
    const random = new NumpyRandom(seed)
    const found = Array.from({ length: 50 }, () => random.next())
    expect(found).toEqual(
      await python(
        'import numpy as np\nprint(json.dumps(np.random.default_rng(input).random(50).tolist()))',
        seed,
      ),
    )
  })
})

describe('a foil of strewn shapes', () => {
  it.each([
    recipe({}),
    recipe({ shape: 'discs', seed: 1, size: 128, cover: 1.5, height: 0.1 }),
    recipe({ shape: 'polygons', cover: null, shape_mm: 1.1, profile: 'blazed' }),
    recipe({ shape: 'polygons', cover: null, shape_mm: 5 }),
    recipe({ distribution: { kind: 'spiral', shortest: 0.9, longest: 3, spread: 0.1 } }),
  ])('is the one that the same recipe bakes: $shape', async (wanted) => {
    const texels = atOnce(stochasticTexels(wanted))
    const { height, tile_mm } = wanted
    const foil = await written('strewn', texels, {
      ...{ height, tile: [tile_mm, tile_mm], recipe: { ...wanted } },
    })
    const [sidecar, found] = (await python(
      `
from pathlib import Path
import numpy as np
from precompute.foils.recipe import StochasticFoilRecipe
from precompute.foils.stochastic import stochastic_foil
from precompute.maps import Map
recipe, folder = input
foil = stochastic_foil(StochasticFoilRecipe.model_validate(recipe), Path("."))
file = Path(folder) / "baked.json"
foil.write(file.parent, "baked")
mine, baked = (Map.read(Path(folder) / name).tables["grating"].values for name in ("strewn", "baked"))
print(json.dumps([json.loads(file.read_text()), float(np.abs(mine - baked).max())]))`,
      [wanted, folder],
    )) as [unknown, number]
    expect(found).toBe(0)
    expect(common(foil)).toEqual(fieldsInCommon(sidecar))
  })

  it('differs from seed to seed', () => {
    const [one, other] = [1, 2].map((seed) => atOnce(stochasticTexels(recipe({ seed }))).values)
    expect(one).not.toEqual(other)
  })
})

describe('periods by orientation', () => {
  const edit: PeriodEdit = { kind: 'period', shortest: 1, longest: 2, bins: 12, blend: 'sin2' }

  it('are those of the edit', () => {
    expect(periodAt(edit, 0)).toBe(1)
    expect(periodAt(edit, Math.PI - 1e-9)).toBe(1)
    expect(periodAt(edit, (11 * Math.PI) / 12)).toBe(2)
    expect(periodAt(edit, (-1 * Math.PI) / 12)).toBe(2)
    expect(periodAt({ ...edit, bins: 3, blend: 'quadratic' }, Math.PI / 3)).toBe(1.25)
  })

  it.each(['foil-polygons', 'foil-logo'])(
    'make the foil that the command makes, of %s',
    async (name) => {
      serveBakedMaps()
      const before = await loadMap(`maps/baked/${name}`)
      const texels = atOnce(withPeriods(before, edit))
      const foil = await written('edited', texels, editedFacts(before, name, edit))
      await promisify(execFile)(
        join(root, venvProgram('diffraction')),
        [
          ...['edit', `maps/baked/${name}.json`, '-o', join(folder, 'by-command')],
          ...['--edit', 'period shortest=1 longest=2 bins=12 blend=sin2'],
        ],
        { cwd: root },
      )
      const [sidecar, found] = (await python(
        `
from pathlib import Path
import numpy as np
from precompute.maps import Map
mine, other = (Map.read(Path(input) / name).tables["grating"].values for name in ("edited", "by-command"))
print(json.dumps([json.loads((Path(input) / "by-command.json").read_text()), float(np.abs(mine - other).max())]))`,
        folder,
      )) as [unknown, number]
      expect(found).toBe(0)
      expect(common(foil)).toEqual(fieldsInCommon(sidecar))
    },
  )

  it('are told after the edits that a foil has had', async () => {
    serveBakedMaps()
    const before = await loadMap('maps/baked/foil-polygons')
    const texels = atOnce(withPeriods(before, edit))
    const once = await written('once', texels, editedFacts(before, 'foil-polygons', edit))
    const again = { ...edit, longest: 3 }
    const { recipe } = editedFacts(once.map, 'once', again)
    expect(recipe).toMatchObject({ from: { map: 'foil-polygons' }, edits: [edit, again] })
  })
})

describe('a map made in the page', () => {
  it('is read by the library and by the command', async () => {
    const wanted = recipe({ shape: 'discs' })
    const texels = atOnce(stochasticTexels(wanted))
    const foil = await written('mine', texels, {
      ...{ height: 0.15, tile: [10, 10] as const, recipe: { ...wanted } },
    })
    serveFiles(
      Object.fromEntries(
        Object.entries(foil.files).map(([file, bytes]) => [`maps/${file}`, bytes]),
      ),
    )
    const loaded = await Foil.load('maps/mine')
    expect(loaded.map.verified).toBe(true)
    expect(loaded.profile).toBe('sinusoidal')
    expect(loaded.tile).toEqual([10, 10])
    expect(loaded.period[0]).toBeGreaterThan(1)
    const { stdout } = await promisify(execFile)(
      join(root, venvProgram('diffraction')),
      ['inspect', join(folder, 'mine.json')],
      { cwd: root },
    )
    expect(stdout).toMatch(/checksums\s+match/)
  })

  it('is refused where nothing diffracts', () => {
    const bare = { rows: 2, columns: 2, values: new Float64Array(16) }
    expect(() => atOnce(stored(bare))).toThrow('strength is 0, expected above 0 somewhere')
  })
})
