import { readFileSync } from 'node:fs'
import { join } from 'node:path'
import { validateCFFFile } from 'cffjs'
import { expect, it } from 'vitest'
import { root } from './markdown'

const file = join(root, 'CITATION.cff')

it('is as the schema of the format says, and of this version', () => {
  const { version, license } = validateCFFFile(file)
  const shipped = JSON.parse(readFileSync(join(root, 'package.json'), 'utf8')) as object
  expect(shipped).toMatchObject({ version, license })
})
