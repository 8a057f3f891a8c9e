/** Work that may be left at each `yield`, and taken up again later. */
export type Steps<Result> = Generator<undefined, Result>

/** How long a thread is kept from other work, ms: half a frame. */
const LONGEST = 8

/** All of it now. */
export function atOnce<Result>(steps: Steps<Result>): Result {
  let step = steps.next()
  while (!step.done) step = steps.next()
  return step.value
}

/** Bit by bit, with time in between for frames and input. */
export async function bitByBit<Result>(steps: Steps<Result>): Promise<Result> {
  let until = performance.now() + LONGEST
  let step = steps.next()
  while (!step.done) {
    if (performance.now() >= until) {
      await otherWork()
      until = performance.now() + LONGEST
    }
    step = steps.next()
  }
  return step.value
}

/** Resolves in a task of its own. Timers would wait longer: browsers hold nested ones back by 4 ms. */
function otherWork(): Promise<void> {
  return new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel()
    port1.onmessage = () => {
      port1.close()
      resolve()
    }
    port2.postMessage(null)
  })
}
