import { expect, it } from 'vitest'
import { DiffractionError } from '../../web/errors'
import { resolveIncludes } from '../../web/glsl/include'

const files = { 'a.glsl': 'A\n#include "b.glsl"', 'b.glsl': 'B $& $1' }

it('takes in files, through files, word for word', () => {
  expect(resolveIncludes('start\n#include "a.glsl"\nend', files)).toBe('start\nA\nB $& $1\nend')
})

it('takes in a file once', () => {
  expect(resolveIncludes('#include "b.glsl"\n#include "a.glsl"', files)).toBe('B $& $1\nA\n')
})

it("leaves three's own includes alone", () => {
  expect(resolveIncludes('#include <common>', files)).toBe('#include <common>')
})

it('throws on a miss, naming file and name', () => {
  expect(() => resolveIncludes('#include "a.glsl"', { 'a.glsl': '#include "c.glsl"' })).toThrow(
    DiffractionError,
  )
  expect(() => resolveIncludes('#include "a.glsl"', { 'a.glsl': '#include "c.glsl"' })).toThrow(
    /a\.glsl: #include is "c\.glsl"/,
  )
})
