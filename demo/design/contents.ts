import { zipSync } from 'fflate'
import { Vector2 } from 'three'
import { Foil } from '../../web'
import type { LoadedMap } from '../../web/maps/load'
import { bitByBit } from '../../web/steps'
import type { Demo } from '../demo'
import { micrometres } from '../inspector/pictures/numbers'
import type { ToolContents } from '../tools/dock'
import { byId, make } from '../ui/elements'
import { saveFile } from '../ui/save-file'
import { segments } from '../ui/segments'
import '../style/plots.css'
import '../style/design.css'
import { readForm, showRefusal, TextField, type AnyField } from './fields'
import { madeFoil, stored, type FoilFacts, type FoilTexels, type StoredFoil } from './foil-map'
import { editedFacts, withPeriods } from './period-edit'
import { PeriodForm } from './period-form'
import { snippet } from './snippet'
import { stochasticTexels } from './stochastic'
import { StochasticForm } from './stochastic-form'

/** Typing goes on while the last foil stands, ms. */
const PAUSE = 300

const WAYS = { strewn: 'Strewn shapes', periods: 'Periods by orientation' } as const

/** A foil that was made, ready to be written under any name. */
interface Design {
  way: keyof typeof WAYS
  texels: FoilTexels
  foil: StoredFoil
  facts: FoilFacts
  /** The map that is on show. */
  map: LoadedMap
}

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
    'my-foil',
    /^[A-Za-z0-9_-]{1,64}$/,
    '1 to 64 letters, digits, - or _',
    () => {
      this.#refresh()
    },
  )
  readonly #make = make('button', 'primary', 'Make the foil')
  readonly #status = make('p', 'note')
  readonly #download = make('button', 'wide', 'Download the map (.zip)')
  readonly #copy = make('button', 'wide', 'Copy the code')
  readonly #code = make('code', '')
  readonly #export = make('section', 'export')
  #way: keyof typeof WAYS = 'strewn'
  /** What was last asked for: what is made for an earlier one is dropped. */
  #asked = 0
  #timer = 0
  #design: Design | null = null
  /** What periods are given to: the last foil on show that has not got them here. */
  #source: LoadedMap | null = null

  constructor(private readonly demo: Demo) {
    const ways = make('fieldset', 'segments ways')
    ways.append(make('legend', 'visually-hidden', 'Way of making it'))
    segments(ways, {
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
    for (const button of [this.#download, this.#copy]) button.type = 'button'
    this.element.append(
      ways,
      this.#forms.strewn.element,
      this.#forms.periods.element,
      this.#make,
      this.#status,
      this.#export,
    )
    this.element.noValidate = true
    this.element.addEventListener('submit', (event) => {
      event.preventDefault()
      void this.#run()
    })
    this.#download.addEventListener('click', () => void this.#save())
    this.#copy.addEventListener('click', () => void this.#copyCode())
    this.#export.hidden = true
    this.#showForm()
  }

  open(): void {
    byId('controls', HTMLFormElement).addEventListener('input', this.#refresh)
    this.#refresh()
  }

  close(): void {
    byId('controls', HTMLFormElement).removeEventListener('input', this.#refresh)
  }

  #showForm(): void {
    for (const way of Object.keys(WAYS) as (keyof typeof WAYS)[])
      this.#forms[way].element.hidden = way !== this.#way
    // Says what is wrong, and draws what is chosen.
    this.#forms[this.#way].read()
  }

  #later(): void {
    clearTimeout(this.#timer)
    this.#timer = window.setTimeout(() => void this.#run(), PAUSE)
  }

  /** Makes the foil of the form and shows it; the last good one stays where that fails. */
  async #run(): Promise<void> {
    clearTimeout(this.#timer)
    const asked = ++this.#asked
    const way = this.#way
    const { fields } = this.#forms[way]
    try {
      const begun = await this.#begin(way)
      if (begun === null) {
        this.#status.textContent = 'A field cannot be used: the last foil stays.'
        return
      }
      this.#status.textContent = 'Making the foil …'
      const texels = await bitByBit(begun.steps)
      const foil = await bitByBit(stored(texels))
      const made = await madeFoil('design', texels, foil, begun.facts)
      // It can be fetched from nowhere.
      const map = { ...made.map, url: '' }
      const shown = await Foil.of(map, { repeat: this.#repeat(begun.facts.tile) })
      if (asked !== this.#asked) return
      await this.demo.showMadeFoil(shown)
      this.#design = { way, texels, foil, facts: begun.facts, map }
      this.#status.textContent = described(texels, foil)
    } catch (error) {
      if (asked !== this.#asked) return
      this.#status.textContent = 'The foil could not be made: the last one stays.'
      this.#refuse(fields, error)
    }
    this.#refresh()
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

  async #begin(
    way: keyof typeof WAYS,
  ): Promise<{ steps: ReturnType<typeof stochasticTexels>; facts: FoilFacts } | null> {
    const { demo } = this
    if (way === 'strewn') {
      const recipe = this.#forms.strewn.read()
      if (recipe === null) return null
      if (!(demo.subject.surface instanceof Foil)) await demo.showSubject('card')
      const { height, tile_mm } = recipe
      const facts: FoilFacts = { height, tile: [tile_mm, tile_mm], recipe: { ...recipe } }
      return { steps: stochasticTexels(recipe), facts }
    }
    const edit = this.#forms.periods.read()
    if (edit === null) return null
    if (!(demo.subject.surface instanceof Foil)) await demo.showSubject('card')
    const { map } = demo.subject.surface as Foil
    // Other values of the same edit take the place of the last ones.
    const isOwn = this.#design?.map === map && this.#design.way === 'periods'
    const source = isOwn && this.#source !== null ? this.#source : this.#named(map)
    this.#source = source
    return { steps: withPeriods(source, edit), facts: editedFacts(source, edit) }
  }

  /** A map that was made here goes by the name that it is given. */
  #named(map: LoadedMap): LoadedMap {
    return this.#design?.map === map ? { ...map, url: this.#nameOr('my-foil') } : map
  }

  /** Tiles as large as they say, on an object as large as it was under the foil before. */
  #repeat([width, height]: readonly [number, number]): Vector2 {
    const { repeat, tile } = this.demo.subject.surface as Foil
    return new Vector2((repeat.x * tile[0]) / width, (repeat.y * tile[1]) / height)
  }

  #nameOr(other: string): string {
    return readForm([this.#name], () => this.#name.read()) ?? other
  }

  async #save(): Promise<void> {
    const name = readForm([this.#name], () => this.#name.read())
    if (name === null || this.#design === null) return
    const { texels, foil, facts } = this.#design
    try {
      const { files } = await madeFoil(name, texels, foil, facts)
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

  readonly #refresh = (): void => {
    const { surface, material } = this.demo.subject
    this.#export.hidden = this.#design === null
    if (this.#design === null || !(surface instanceof Foil) || surface.map !== this.#design.map)
      return
    const name = readForm([this.#name], () => this.#name.read())
    if (name !== null) this.#code.textContent = snippet(name, surface, material)
  }
}

function described({ rows, columns }: FoilTexels, foil: StoredFoil): string {
  const [shortest, longest] = [1 / foil.maxFrequency, 1 / foil.minFrequency]
  return (
    `On show: ${columns} × ${rows} texels, periods ${micrometres(shortest)} to ${micrometres(longest)}, ` +
    `rounded to 8 bits by ${(100 * foil.error).toFixed(2)}\u202f% (RMS).`
  )
}
