import { expect, it, vi } from 'vitest'
import { atOnce, bitByBit, type Steps } from '../../web/steps'

function* counting(to: number, done: number[]): Steps<number> {
  for (let i = 0; i < to; i++) {
    done.push(i)
    yield
  }
  return to
}

it('does all of the work at once', () => {
  const done: number[] = []
  expect(atOnce(counting(3, done))).toBe(3)
  expect(done).toEqual([0, 1, 2])
})

it('leaves the thread to others once its time is up, and only then', async () => {
  let now = 0
  const clock = vi.spyOn(performance, 'now').mockImplementation(() => now)
  const done: number[] = []
  function* slow(): Steps<string> {
    for (const step of counting(9, done)) {
      now += 3
      yield step
    }
    return 'done'
  }
  const result = bitByBit(slow())
  // Up to 8 ms are taken before anybody else runs.
  expect(done).toEqual([0, 1, 2])
  expect(await result).toBe('done')
  clock.mockRestore()
  expect(done).toHaveLength(9)
})

it('fails as the work does', async () => {
  function* failing(): Steps<never> {
    yield
    throw new Error('no')
  }
  await expect(bitByBit(failing())).rejects.toThrow('no')
})
