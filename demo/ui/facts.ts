import type { DiffractionMaterial } from '../../web'
import { measuredError } from '../compare/measured-error'
import type { Demo } from '../demo'
import { byId, make } from './elements'
import { METHODS } from './methods'

/** Says beside the picture by which method it was drawn, how far off that is, and how long a frame took. */
export function showFacts(demo: Demo): void {
  const { subject, comparison, viewer } = demo
  const materials = [subject.material, ...(comparison.other === null ? [] : [comparison.other])]
  const facts = materials.map((material, i) => {
    const time = viewer.frameTimes[i] ?? Infinity
    return make(
      'p',
      '',
      make('b', '', METHODS[material.method]),
      make('span', '', [errorText(demo, material), timeText(time)].filter(Boolean).join(' · ')),
    )
  })
  const difference = comparison.difference()
  const between =
    difference === null
      ? []
      : [make('p', 'difference', make('span', '', `They differ by ${percent(difference)} here`))]
  byId('facts', HTMLDivElement).replaceChildren(...facts, ...between)
}

function errorText({ flash, surroundings }: Demo, material: DiffractionMaterial): string {
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
