import { existsSync, mkdtempSync, rmSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { join } from 'node:path'
import {
  Application,
  TSConfigReader,
  TypeDocReader,
  type OptionsReader,
  type ProjectReflection,
  type TypeDocOptions,
} from 'typedoc'
import { describe, expect, it } from 'vitest'
import { pdocCommand } from '../../scripts/pdoc.mjs'
import { collect } from '../../scripts/process.mjs'
import { undocumented, withoutUnit } from './documented'
import { root } from './markdown'

/** Throws where TypeDoc warns: of a type that is not exported, or a link that leads nowhere. */
async function apiOf(
  options: Partial<TypeDocOptions>,
  readers: OptionsReader[],
): Promise<ProjectReflection> {
  const app = await Application.bootstrap(options, readers)
  const project = await app.convert()
  if (project === undefined) throw new Error('TypeDoc cannot read the sources')
  app.validate(project)
  expect(app.logger.hasWarnings() || app.logger.hasErrors()).toBe(false)
  return project
}

describe('three-diffraction', async () => {
  const options = { options: join(root, 'typedoc.json') }
  const api = await apiOf(options, [new TypeDocReader(), new TSConfigReader()])

  it('says something of every export, member and parameter', () => {
    expect(undocumented(api)).toEqual([])
  })

  it('says the unit of every quantity, or that it has none', () => {
    expect(withoutUnit(api)).toEqual([])
  })
})

it('documents precompute without a warning', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'three-diffraction-pdoc-'))
  try {
    const [pdoc, ...args] = pdocCommand(folder)
    // pdoc warns, of a type that it cannot read or a module that it cannot import, and goes on.
    expect(await collect(pdoc, args)).toEqual({ passed: true, output: '', problem: '' })
    expect(existsSync(join(folder, 'precompute/reference.html'))).toBe(true)
  } finally {
    rmSync(folder, { recursive: true })
  }
})

it('is strict', async () => {
  const folder = join(root, 'tests/docs/poorly-documented')
  const poor = await apiOf(
    {
      entryPoints: [join(folder, 'index.ts')],
      tsconfig: join(folder, 'tsconfig.json'),
      disableSources: true,
      readme: 'none',
    },
    [new TSConfigReader()],
  )
  expect(undocumented(poor)).toEqual(['Poor.silent', 'poor(length)', 'poor(names)'])
  const quantities = withoutUnit(poor).map((line) => line.split(':')[0])
  expect(quantities.sort()).toEqual(['Poor.width', 'means', 'poor()', 'poor(length)'])
})
