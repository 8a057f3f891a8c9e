import type { Foil, Grating } from '../../../web'
import { make } from '../../ui/elements'
import type { Direction } from '../optics/orders'
import type { PointOptics } from '../point-optics'
import { degrees, micrometres, number, percent } from './numbers'

/** What there is at the point, in numbers. */
export class Facts {
  readonly element = make('section', 'point-facts')
  readonly #list = make('dl', '')

  constructor() {
    this.element.append(
      make(
        'p',
        'note',
        'Tap the object, or move the crosshair with the arrow keys: all below is of that point.',
      ),
      this.#list,
    )
  }

  show(optics: PointOptics): void {
    const { point, wi, wo, irradiance } = optics
    const rows: [string, string][] = [
      ['Place (u, v)', `${number(point.uv.x, 4)}, ${number(point.uv.y, 4)}`],
      ...surfaceFacts(optics),
      ['Light ω_i', direction(wi)],
      ['View ω_o', direction(wo)],
      ['Irradiance of the flash', wi[2] > 0 ? number(irradiance * wi[2]) : 'below the horizon'],
    ]
    this.#list.replaceChildren(
      ...rows.map(([term, value]) => make('div', '', make('dt', '', term), make('dd', '', value))),
    )
  }
}

function surfaceFacts({ surface, grating, strength, relief }: PointOptics): [string, string][] {
  if (grating === null) {
    const patch = relief!.relief.patch.map((length) => number(length, 4)).join(' × ')
    return [
      ['Height field', `repeats every ${patch} µm`],
      ['Strength', percent(strength)],
    ]
  }
  const { at } = grating
  const { height, profile } = surface as Foil | Grating
  const turn = at.orientation - Math.PI * Math.floor(at.orientation / Math.PI)
  return [
    ...(at.texel === null
      ? []
      : [['Texel', `column ${at.texel.column}, row ${at.texel.row}`] as [string, string]]),
    ['Orientation θ', at.period === null ? 'nothing diffracts' : degrees(turn)],
    ['Period a', at.period === null ? '–' : micrometres(at.period)],
    ['Relief', `${micrometres(height)}, ${profile}`],
    ['Strength', percent(strength)],
  ]
}

/** A direction of the grating's frame, by its angles. */
function direction([t, b, n]: Direction): string {
  return `${degrees(Math.acos(Math.min(Math.max(n, -1), 1)), 0)} off the normal, ${degrees(Math.atan2(b, t), 0)} from t`
}
