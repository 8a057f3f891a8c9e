/** A moving picture is to have about this long for a frame, ms. */
const TARGET = 40

/** Share of the full resolution, in each direction, that a machine can draw while the picture moves. */
export class MovingResolution {
  #scale = 0.6
  #last = 0

  get scale(): number {
    return this.#scale
  }

  /** To be called with the time of each frame drawn in motion, ms. */
  frame(now: number): void {
    const interval = now - this.#last
    this.#last = now
    // The first frame of a motion says nothing: before it lay a pause.
    if (interval > 1000) return
    if (interval > 1.5 * TARGET) this.#scale = Math.max(this.#scale * 0.85, 1 / 3)
    else if (interval < 0.7 * TARGET) this.#scale = Math.min(this.#scale * 1.1, 1)
  }
}
