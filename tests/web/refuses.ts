import { expect } from 'vitest'
import { DiffractionError } from '../../web/errors'

/** Expects an action to throw the one error that names file and field. */
export function refuses(action: () => unknown, file: string, field: string): void {
  let caught: unknown
  try {
    action()
  } catch (error) {
    caught = error
  }
  expect(caught).toBeInstanceOf(DiffractionError)
  expect(caught).toMatchObject({ file, field })
}
