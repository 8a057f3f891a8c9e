import type { Steps } from '../../web/steps'

/** Work that may be left at each `yield`, where it tells how much of it is done, 0 to 1. */
export type Work<Result> = Generator<number, Result>

/** Work that is a part of more, from one share of it to another. */
export function* part<Result>(from: number, to: number, work: Work<Result>): Work<Result> {
  let step = work.next()
  while (!step.done) {
    yield from + (to - from) * step.value
    step = work.next()
  }
  return step.value
}

/**
 * The steps of a work.
 *
 * @param tell - hears of each share; what it throws ends the work
 */
export function* told<Result>(work: Work<Result>, tell: (share: number) => void): Steps<Result> {
  let step = work.next()
  while (!step.done) {
    tell(step.value)
    yield
    step = work.next()
  }
  return step.value
}
