import type { Demo } from '../demo'
import { linkTo } from '../link/link'
import type { Setting } from '../link/setting'
import { canSenseMotion, Motion } from '../view/motion'
import { byId } from './elements'
import { saveFile } from './save-file'

/** The buttons below the view. */
export class Actions {
  readonly #motion: Motion

  constructor(
    private readonly demo: Demo,
    private readonly settings: readonly Setting[],
  ) {
    const { tilt, comparison, viewer } = demo
    this.#motion = new Motion((right, down) => {
      tilt.turn(right, down)
      viewer.invalidate()
    })
    toggle('sway', () => {
      tilt.isSwaying = !tilt.isSwaying
      viewer.invalidate()
      return tilt.isSwaying
    })
    toggle('compare', () => {
      comparison.compare(comparison.isOn ? null : demo.subject)
      demo.onChanged()
      return comparison.isOn
    })
    byId('motion', HTMLButtonElement).hidden = !canSenseMotion()
    toggle('motion', async () => {
      if (this.#motion.isOn) this.#motion.stop()
      else await demo.tell(this.#motion.start())
      return this.#motion.isOn
    })
    byId('share', HTMLButtonElement).addEventListener('click', () => void this.#share())
    byId('save', HTMLButtonElement).addEventListener('click', () => void this.#save())
  }

  async #share(): Promise<void> {
    const { demo } = this
    const link = linkTo(location.href, this.settings)
    history.replaceState(null, '', link)
    const { onShow, inLink } = demo.designs
    const done =
      onShow === inLink
        ? 'The link is copied.'
        : 'The link is copied, without the foil: part of it is in a file of yours. Download its map to pass it on.'
    await demo.tell(navigator.clipboard.writeText(link), done)
  }

  async #save(): Promise<void> {
    const { demo } = this
    const picture = await demo.tell(demo.viewer.picture())
    if (picture === undefined) return
    saveFile(picture, `three-diffraction-${demo.subjectName}.png`)
  }
}

/** A button that stays pressed while what it stands for is on. */
function toggle(id: string, turn: () => boolean | Promise<boolean>): void {
  const button = byId(id, HTMLButtonElement)
  button.addEventListener('click', () => {
    void Promise.resolve(turn()).then((isOn) => {
      button.setAttribute('aria-pressed', String(isOn))
    })
  })
}
