import { DataTexture } from 'three'
import { expect, it } from 'vitest'
import type { LoadedMap } from '../../web/maps/load'
import { sharedInSteps } from '../../web/maps/shared-texture'
import { atOnce, type Steps } from '../../web/steps'

/** Takes so many steps, and says when one was. */
function* slow(done: number[], steps = 4): Steps<DataTexture> {
  for (let i = 0; i < steps; i++) {
    yield
    done.push(i)
  }
  return new DataTexture()
}

it('goes on with what another has begun, and gives both the same', () => {
  const map = {} as LoadedMap
  const done: number[] = []
  const make = (): Steps<DataTexture> => slow(done)
  const [one, other] = [sharedInSteps(map, 'x', make), sharedInSteps(map, 'x', make)]
  for (let i = 0; i < 3; i++) {
    one.next()
    other.next()
  }
  const texture = atOnce(other)
  expect(atOnce(one)).toBe(texture)
  expect(done).toEqual([0, 1, 2, 3])
  expect(sharedInSteps(map, 'x', make).next()).toEqual({ done: true, value: texture })
})

it('finishes both of two that are made of one map by turns', () => {
  const map = {} as LoadedMap
  const [done, alsoDone]: number[][] = [[], []]
  const one = sharedInSteps(map, 'x', () => slow(done!))
  const other = sharedInSteps(map, 'y', () => slow(alsoDone!))
  const results: unknown[] = []
  for (let i = 0; i < 6; i++) results.push(one.next().value, other.next().value)
  expect(new Set(results.filter(Boolean)).size).toBe(2)
  expect([done, alsoDone]).toEqual([
    [0, 1, 2, 3],
    [0, 1, 2, 3],
  ])
})

it('fails for all who want what cannot be made, whoever was first', () => {
  const map = {} as LoadedMap
  function* failing(): Steps<DataTexture> {
    yield
    throw new Error('no')
  }
  const [one, other] = [sharedInSteps(map, 'x', failing), sharedInSteps(map, 'x', failing)]
  one.next()
  other.next()
  expect(() => atOnce(one)).toThrow('no')
  expect(() => atOnce(other)).toThrow('no')
  expect(() => atOnce(sharedInSteps(map, 'x', failing))).toThrow('no')
})
