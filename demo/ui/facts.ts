import type { DiffractionMaterial } from '../../web'
import { measuredError } from '../compare/measured-error'
import type { Demo } from '../demo'
import { byId, make } from './elements'
import { METHODS } from './methods'

/** How long a picture has to stand before its error is measured, ms: one that soon moves on has no use for it. */
const REST = 400

/** Says beside the picture by which method it was drawn, how far off that is, and how long a frame took. */
export class Facts {
  readonly #element = byId('facts', HTMLDivElement)
  #pictures = 0

  constructor(private readonly demo: Demo) {}

  /** To be called when the picture is finished. */
  refresh(): void {
    const difference = this.demo.comparison.difference()
    this.#show(difference, null)
    const picture = ++this.#pictures
    if (this.demo.errorSource === 'view') void this.demo.tell(this.#measure(difference, picture))
  }

  async #measure(difference: number | null, picture: number): Promise<void> {
    const { viewer, comparison } = this.demo
    const isStale = (): boolean => picture !== this.#pictures || !viewer.isSettled
    await new Promise((resolve) => setTimeout(resolve, REST))
    if (isStale()) return
    // Not before it is needed: the first picture comes without.
    const { viewErrors } = await import('../compare/view-error')
    const errors = await viewErrors(this.demo, comparison.ways, isStale)
    if (errors !== null && !isStale()) this.#show(difference, errors)
  }

  /** @param errors - of this view; null where they are not known, then those of the report are told */
  #show(difference: number | null, errors: readonly number[] | null): void {
    const { subject, comparison, viewer } = this.demo
    const materials = [subject.material, ...(comparison.other === null ? [] : [comparison.other])]
    const facts = materials.map((material, i) => {
      const time = viewer.frameTimes[i] ?? Infinity
      const texts = [
        errors === null ? reportText(this.demo, material) : `${percent(errors[i]!)} off here`,
        timeText(time),
      ]
      return make(
        'p',
        '',
        make('b', '', METHODS[material.method]),
        ' ',
        make('span', '', texts.filter(Boolean).join(' · ')),
      )
    })
    const between =
      difference === null
        ? []
        : [make('p', 'difference', make('span', '', `They differ by ${percent(difference)} here`))]
    this.#element.replaceChildren(...facts, ...between)
  }
}

function reportText({ flash, surroundings }: Demo, material: DiffractionMaterial): string {
  const error = measuredError(material, {
    lights: flash.intensity > 0,
    environment: surroundings.loaded !== null,
  })
  return error === null ? 'not in the report' : `report: up to ${percent(error)} off`
}

function timeText(milliseconds: number): string {
  if (!Number.isFinite(milliseconds)) return ''
  return `${milliseconds < 10 ? milliseconds.toFixed(1) : milliseconds.toFixed(0)}\u202fms`
}

function percent(share: number): string {
  return `${Number((100 * share).toPrecision(2))}\u202f%`
}
