import { zipSync } from 'fflate'
import { Foil } from '../../web'
import type { Demo } from '../demo'
import { micrometres } from '../inspector/pictures/numbers'
import type { ToolContents } from '../tools/dock'
import type { Control } from '../ui/control'
import { byId, make } from '../ui/elements'
import { saveFile } from '../ui/save-file'
import { segments } from '../ui/segments'
import '../style/plots.css'
import '../style/design.css'
import { DEFAULT_NAME, type Design } from './design'
import { readForm, showRefusal, TextField, type AnyField } from './fields'
import { madeFoil, type StoredFoil } from './foil-map'
import { PeriodForm } from './period-form'
import { snippet } from './snippet'
import { StochasticForm } from './stochastic-form'

/** Typing goes on while the last foil stands, ms. */
const PAUSE = 300

const WAYS = { strewn: 'Strewn shapes', periods: 'Periods by orientation' } as const

type Way = keyof typeof WAYS

/** The forms by which foils are made, and what can be done with the last one. */
export class DesignContents implements ToolContents {
  readonly element = make('form', 'design')
  readonly #forms = {
    strewn: new StochasticForm(() => {
      this.#later()
    }),
    periods: new PeriodForm(() => {
      this.#later()
    }),
  }
  readonly #name = new TextField(
    'name',
    'Name of the map',
    DEFAULT_NAME,
    /^[A-Za-z0-9_-]{1,64}$/,
    '1 to 64 letters, digits, - or _',
    () => {
      this.#showCode()
    },
  )
  readonly #ways: Control
  readonly #make = make('button', 'primary', 'Make the foil')
  readonly #stop = make('button', 'wide', 'Stop')
  readonly #status = make('p', 'note')
  readonly #download = make('button', 'wide', 'Download the map (.zip)')
  readonly #copy = make('button', 'wide', 'Copy the code')
  readonly #code = make('code', '')
  readonly #export = make('section', 'export')
  #way: Way = 'strewn'
  #timer = 0
  /** What was last asked for: recipe or edit. */
  #asked: object | null = null
  /** How the foil on show was made, as far as it is shown here. */
  #design: Design | null = null

  constructor(private readonly demo: Demo) {
    const ways = make('fieldset', 'segments ways')
    ways.append(make('legend', 'visually-hidden', 'Way of making it'))
    this.#ways = segments(ways, {
      options: WAYS,
      get: () => this.#way,
      set: (way) => {
        this.#way = way
        this.#showForm()
      },
    })
    this.#status.setAttribute('role', 'status')
    const pre = make('pre', '', this.#code)
    Object.assign(pre, { tabIndex: 0, ariaLabel: 'Code' })
    pre.setAttribute('role', 'region')
    this.#export.append(
      make('h3', '', 'Take it with you'),
      this.#name.element,
      this.#download,
      pre,
      this.#copy,
    )
    for (const button of [this.#stop, this.#download, this.#copy]) button.type = 'button'
    this.element.append(
      ways,
      this.#forms.strewn.element,
      this.#forms.periods.element,
      this.#make,
      this.#stop,
      this.#status,
      this.#export,
    )
    this.element.noValidate = true
    this.element.addEventListener('submit', (event) => {
      event.preventDefault()
      void this.#run()
    })
    this.#stop.addEventListener('click', () => {
      demo.designs.stop()
    })
    this.#download.addEventListener('click', () => void this.#save())
    this.#copy.addEventListener('click', () => void this.#copyCode())
    this.#stop.hidden = true
    this.#export.hidden = true
    this.#showForm()
  }

  open(): void {
    byId('controls', HTMLFormElement).addEventListener('input', this.#showCode)
    this.refresh()
  }

  close(): void {
    byId('controls', HTMLFormElement).removeEventListener('input', this.#showCode)
  }

  /** Shows how the foil on show was made, if it was made in the page, and what can be done with it. */
  refresh(): void {
    const { onShow } = this.demo.designs
    if (onShow === this.#design) {
      this.#showCode()
      return
    }
    this.#design = onShow
    this.#export.hidden = onShow === null
    this.#status.textContent = onShow === null ? '' : described(onShow.foil)
    if (onShow === null) return
    this.#showCode()
    const { recipe, edited } = onShow
    // Fields hold what was asked for here, or what was typed since.
    if ((edited?.edit ?? recipe) === this.#asked) return
    if (recipe !== null) this.#forms.strewn.fill(recipe)
    if (edited !== null) this.#forms.periods.fill(edited.edit)
    this.#way = edited === null ? 'strewn' : 'periods'
    this.#ways.refresh()
    this.#showForm()
  }

  #showForm(): void {
    for (const way of Object.keys(WAYS) as Way[])
      this.#forms[way].element.hidden = way !== this.#way
    // Says what is wrong, and draws what is chosen.
    this.#forms[this.#way].read()
  }

  #later(): void {
    this.demo.designs.stop()
    clearTimeout(this.#timer)
    this.#timer = window.setTimeout(() => void this.#run(), PAUSE)
  }

  /** Makes the foil of the form and shows it; the last good one stays where that fails. */
  async #run(): Promise<void> {
    clearTimeout(this.#timer)
    const { demo } = this
    const form = this.#forms[this.#way]
    const wanted = form.read()
    this.#asked = wanted
    if (wanted === null) {
      demo.designs.stop()
      this.#stop.hidden = true
      this.#status.textContent = 'A field cannot be used: the last foil stays.'
      return
    }
    this.#status.textContent = 'Making the foil …'
    this.#stop.hidden = false
    try {
      if (demo.subject.repeat === undefined) await demo.showSubject('card')
      const isMade =
        wanted.kind === 'foil'
          ? await demo.designs.strew(wanted)
          : await demo.designs.givePeriods(wanted, this.#nameOr(DEFAULT_NAME))
      if (!isMade && this.#asked === wanted) this.#status.textContent = 'Stopped.'
    } catch (error) {
      if (this.#asked !== wanted) return
      this.#status.textContent = 'The foil could not be made: the last one stays.'
      this.#refuse(form.fields, error)
    } finally {
      if (this.#asked === wanted) this.#stop.hidden = true
    }
  }

  /** Beside its field where it is one's: that is enough of it. */
  #refuse(fields: readonly AnyField[], error: unknown): void {
    try {
      showRefusal(fields, error)
      this.demo.banner.hide()
    } catch {
      this.demo.banner.show(error)
    }
  }

  #nameOr(other: string): string {
    return readForm([this.#name], () => this.#name.read()) ?? other
  }

  async #save(): Promise<void> {
    const name = readForm([this.#name], () => this.#name.read())
    if (name === null || this.#design === null) return
    const { foil, facts } = this.#design
    try {
      const { files } = await madeFoil(name, foil, facts)
      // Images are compressed already.
      const zip = zipSync(files, { level: 0 })
      saveFile(new Blob([zip], { type: 'application/zip' }), `${name}.zip`)
      this.#status.textContent = `Saved ${name}.zip: ${Object.keys(files).join(', ')}.`
    } catch (error) {
      this.demo.banner.show(error)
    }
  }

  async #copyCode(): Promise<void> {
    try {
      await navigator.clipboard.writeText(this.#code.textContent)
      this.#status.textContent = 'The code is copied.'
    } catch {
      // Where the page may not write there, the reader can.
      getSelection()?.selectAllChildren(this.#code)
      this.#status.textContent = 'The browser did not let the page copy: the code is selected.'
    }
  }

  readonly #showCode = (): void => {
    const { surface, material } = this.demo.subject
    if (this.#design === null || !(surface instanceof Foil)) return
    const name = readForm([this.#name], () => this.#name.read())
    if (name !== null) this.#code.textContent = snippet(name, surface, material)
  }
}

function described(foil: StoredFoil): string {
  const [shortest, longest] = [1 / foil.maxFrequency, 1 / foil.minFrequency]
  return (
    `On show: ${foil.columns} × ${foil.rows} texels, periods ${micrometres(shortest)} to ${micrometres(longest)}, ` +
    `rounded to 8 bits by ${(100 * foil.error).toFixed(2)}\u202f% (RMS).`
  )
}
