import { Foil } from '../../web'
import type { Demo } from '../demo'
import type { Setting } from '../link/setting'
import { FOILS } from '../subjects/foils'
import { choice } from './choice'
import type { Control } from './control'
import { make, uniqueId } from './elements'

/** The pattern of a foil that was made in the page. */
const DESIGNED = 'designed'

/** One of the foils that come with the page, or the address of a map, to try another; and the period that it states. */
export function foilField(demo: Demo): { choice: Control; address: Control; setting: Setting } {
  const isFoil = (): boolean => demo.subject.surface instanceof Foil
  const pattern = choice<string>(
    {
      name: 'pattern',
      label: 'Pattern',
      options: { ...FOILS, [DESIGNED]: 'Designed here' },
      offered: () => [
        ...(demo.designs.onShow === null ? [] : [DESIGNED]),
        ...Object.keys(FOILS),
      ],
      get: () => {
        if (!isFoil()) return undefined
        if (demo.designs.onShow !== null) return DESIGNED
        return demo.foilUrl in FOILS ? demo.foilUrl : ''
      },
      set: async (pattern) => {
        if (pattern !== '' && pattern !== DESIGNED) await demo.tell(demo.showFoil(pattern))
      },
    },
    demo.attempt,
  )
  const setting: Setting = {
    name: 'foil',
    read: () => {
      const url = demo.designs.onShow?.edited?.source.url ?? demo.foilUrl
      // Strewn shapes have no address.
      return url === '' ? undefined : url
    },
    write: (url) => demo.showFoil(url),
  }
  return { choice: pattern, address: addressField(demo), setting }
}

function addressField(demo: Demo): Control {
  const id = uniqueId()
  const input = make('input', '')
  Object.assign(input, { type: 'text', id, spellcheck: false })
  const label = make('label', '', 'Foil map (address without extension)')
  label.htmlFor = id
  const load = make('button', '', 'Load')
  load.type = 'button'
  const period = make('output', '')
  const element = make(
    'div',
    'control text',
    label,
    input,
    load,
    make('span', 'fact', 'Period ', period),
  )

  const submit = (): void => {
    void demo.tell(demo.showFoil(input.value.trim()))
  }
  load.addEventListener('click', submit)
  input.addEventListener('keydown', (event) => {
    if (event.key === 'Enter') submit()
  })

  let shown = ''
  const refresh = (): void => {
    const { surface } = demo.subject
    element.hidden = !(surface instanceof Foil)
    if (!(surface instanceof Foil)) return
    // A text that was refused stays, to be corrected.
    if (shown !== demo.foilUrl) input.value = shown = demo.foilUrl
    const [shortest, longest] = surface.period.map((length) => length.toFixed(2))
    period.textContent =
      shortest === longest
        ? `${String(shortest)}\u202fµm`
        : `${String(shortest)} to ${String(longest)}\u202fµm`
  }
  return { element, refresh }
}
