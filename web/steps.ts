/** Work that may be left at each `yield`, and taken up again later. */
export type Steps<Result> = Generator<undefined, Result>

/** How long a thread is kept from other work, ms: half a frame, or as long as that work takes, but never a long task. */
const USUAL = 8
const LONGEST = 40

/** All of it now. */
export function atOnce<Result>(steps: Steps<Result>): Result {
  let step = steps.next()
  while (!step.done) step = steps.next()
  return step.value
}

/** Bit by bit, with time in between for frames and input. */
export async function bitByBit<Result>(steps: Steps<Result>): Promise<Result> {
  let until = performance.now() + USUAL
  let step = steps.next()
  while (!step.done) {
    const left = performance.now()
    if (left >= until) {
      await otherWork()
      const back = performance.now()
      until = back + Math.min(Math.max(back - left, USUAL), LONGEST)
    }
    step = steps.next()
  }
  return step.value
}

/** Resolves in a task of its own. Timers would wait longer: browsers hold nested ones back by 4 ms. */
export function otherWork(): Promise<void> {
  return new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel()
    port1.onmessage = () => {
      port1.close()
      resolve()
    }
    port2.postMessage(null)
  })
}
