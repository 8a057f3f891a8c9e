import { Vector2 } from 'three'
import { Foil } from '../../web'
import type { LoadedMap } from '../../web/maps/load'
import type { Demo } from '../demo'
import type { Design } from './design'
import type { Making } from './make-foil'
import type { PeriodEdit } from './period-edit'
import type { StochasticRecipe } from './stochastic-recipe'

/** Side of the tiles of which an object's `repeat` gives it its size, mm. */
const TILE_MM = 25

/** Makes foils and covers the object on show with them; the last thing asked for overtakes what is being made. */
export class Designs {
  readonly #made = new WeakMap<LoadedMap, Design>()
  #making = new AbortController()

  constructor(private readonly demo: Demo) {}

  /** How the foil on show was made; null where it was not made here. */
  get onShow(): Design | null {
    const { surface } = this.demo.subject
    return surface instanceof Foil ? (this.#made.get(surface.map) ?? null) : null
  }

  /** Strews shapes. Resolves to false where that was stopped; rejects where the foil cannot be made or drawn. */
  strew(recipe: StochasticRecipe): Promise<boolean> {
    return this.#make(async (making) => {
      const { makeStrewn } = await import('./make-foil')
      return makeStrewn(recipe, making)
    })
  }

  /**
   * Gives the foil on show periods by orientation; periods that it was given here before are replaced. As `strew`.
   *
   * @param name - of a foil that was made here, in the recipe of what is made of it
   */
  givePeriods(edit: PeriodEdit, name: string): Promise<boolean> {
    const { onShow } = this
    return this.#make(async (making, surface) => {
      const { makeEdited } = await import('./make-foil')
      const source = onShow?.edited?.source ?? surface.map
      return makeEdited({ source, recipe: onShow?.recipe ?? null, name, edit }, making)
    })
  }

  /** Drops what is being made. */
  stop(): void {
    this.#making.abort()
  }

  async #make(
    make: (making: Making, surface: Foil) => Promise<{ design: Design; map: LoadedMap }>,
  ): Promise<boolean> {
    this.stop()
    const { signal } = (this.#making = new AbortController())
    const { subject, loading } = this.demo
    const { repeat, surface } = subject
    // Foils cover some objects alone.
    if (repeat === undefined || !(surface instanceof Foil)) return false
    try {
      await loading.track('Making the foil …', async (tell) => {
        const { design, map } = await make({ signal, tell }, surface)
        const [width, height] = design.facts.tile
        const tiles =
          design.edited === null
            ? new Vector2(repeat.x / width, repeat.y / height).multiplyScalar(TILE_MM)
            : surface.repeat
        const foil = await Foil.of(map, { repeat: tiles })
        signal.throwIfAborted()
        this.#made.set(map, design)
        await this.demo.showMadeFoil(subject, foil)
      })
      return true
    } catch (error) {
      if (signal.aborted) return false
      throw error
    }
  }
}
