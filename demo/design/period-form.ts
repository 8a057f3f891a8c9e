import { Chart, type ChartAxis } from '../inspector/pictures/chart'
import { micrometres, number } from '../inspector/pictures/numbers'
import { make, uniqueId } from '../ui/elements'
import { ChoiceField, fillForm, NumberField, readForm, type AnyField } from './fields'
import { BLENDS, EDIT_RANGES, periodAt, readEdit, textsOfEdit, type PeriodEdit } from './period-edit'

/** More steps than there are pixels. */
const STEPS = 720

/** The fields of periods by orientation, and what they make of each orientation. */
export class PeriodForm {
  readonly element = make('div', 'form')
  readonly fields: readonly AnyField[]
  readonly #chart = new Chart(150)
  readonly #caption = make('figcaption', '')

  constructor(onChange: () => void) {
    const field = (name: keyof typeof EDIT_RANGES, label: string, value: number): NumberField =>
      new NumberField({ name, label, value, ...EDIT_RANGES[name] }, onChange)
    this.fields = [
      field('shortest', 'Period at 0°', 1.2),
      field('longest', 'Period towards 180°', 2),
      field('bins', 'Ranges of orientation', 12),
      new ChoiceField('blend', 'From first to last', BLENDS, onChange),
    ] as AnyField[]
    this.#caption.id = uniqueId()
    const { element: picture } = this.#chart
    picture.setAttribute('role', 'img')
    picture.setAttribute('aria-labelledby', this.#caption.id)
    this.element.append(
      make('p', 'note', 'Gives the gratings of the foil on show periods by their orientation.'),
      ...this.fields.map(({ element }) => element),
      make('figure', 'preview', picture, this.#caption),
    )
  }

  /** The edit, or null where a field is refused. */
  read(): PeriodEdit | null {
    const edit = readForm(this.fields, readEdit)
    if (edit !== null) this.#draw(edit)
    return edit
  }

  /** Takes an edit's values over. */
  fill(edit: PeriodEdit): void {
    fillForm(this.fields, textsOfEdit(edit))
  }

  #draw(edit: PeriodEdit): void {
    const { shortest, longest, bins } = edit
    const room = Math.max(longest - shortest, 0.1)
    const x: ChartAxis = {
      ...{ from: 0, to: 180, ticks: [0, 45, 90, 135, 180] },
      ...{ label: 'orientation θ', write: (value: number) => `${value}°` },
    }
    const y: ChartAxis = {
      ...{ from: shortest - 0.1 * room, to: longest + 0.1 * room, ticks: [shortest, longest] },
      ...{ label: 'period, µm', write: (value: number) => number(value) },
    }
    const points = Array.from({ length: STEPS + 1 }, (_, i): [number, number] => {
      const angle = (180 * i) / STEPS
      return [angle, periodAt(edit, (angle * Math.PI) / 180)]
    })
    this.#chart.draw(x, y, this.#chart.curve(x, y, points, 'flash'))
    const middle = periodAt(edit, Math.PI / 2)
    this.#caption.textContent = `${bins} ranges of ${number(180 / bins)}°, the first about 0°: ${micrometres(shortest)} there, ${micrometres(middle)} at 90°, ${micrometres(longest)} in the last.`
  }
}
