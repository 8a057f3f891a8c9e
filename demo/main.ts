import { Demo } from './demo'
import { DesignPanel } from './design/design-panel'
import { isEnvironmentName } from './light/environments'
import { Inspector } from './inspector/inspector'
import { isSubjectName, SUBJECTS } from './subjects'
import { Dock } from './tools/dock'
import { byId } from './ui/elements'
import { Explanation } from './ui/explanation'
import { Panel } from './ui/panel'
import { segments } from './ui/segments'
import { showStatus } from './ui/status'
import { keepSheet } from './ui/sheet'
import { requireContext, UnsupportedError } from './view/capabilities'
import { DRAG_MODES, listenToDrags, type DragMode } from './view/drag'
import { listenToKeys } from './view/keys'
import { Viewer } from './view/viewer'

const canvas = byId('view', HTMLCanvasElement)

/** `?scene=disc&environment=night&foil=ADDRESS` opens the page on something else. */
const parameters = new URLSearchParams(location.search)

try {
  await start(requireContext(canvas))
} catch (error) {
  if (!(error instanceof UnsupportedError)) throw error
  byId('unsupported-text', HTMLParagraphElement).textContent = error.message
  byId('unsupported', HTMLElement).hidden = false
  byId('stage', HTMLElement).hidden = true
  byId('sheet', HTMLDetailsElement).hidden = true
}

async function start(context: WebGL2RenderingContext): Promise<void> {
  keepSheet(byId('sheet', HTMLDetailsElement))
  let dragMode: DragMode = 'object'
  // Dragging object and flash has to be heard of before dragging the camera.
  const viewer = new Viewer(canvas, context)
  const demo = new Demo(viewer)
  const movable = {
    orbit: viewer.orbit,
    camera: viewer.camera,
    tilt: demo.tilt,
    flash: demo.flash,
    changed: () => {
      viewer.invalidate()
      demo.onChanged()
    },
  }
  listenToDrags(canvas, movable, () => dragMode)
  listenToKeys(canvas, movable, () => dragMode)
  segments(byId('drag-modes', HTMLFieldSetElement), {
    options: DRAG_MODES,
    get: () => dragMode,
    set: (mode) => (dragMode = mode),
  })
  const sway = byId('sway', HTMLButtonElement)
  sway.addEventListener('click', () => {
    demo.tilt.isSwaying = !demo.tilt.isSwaying
    sway.setAttribute('aria-pressed', String(demo.tilt.isSwaying))
    viewer.invalidate()
  })

  const scene = parameters.get('scene')
  const environment = parameters.get('environment')
  const foil = parameters.get('foil')
  await Promise.all([
    demo.showSubject(isSubjectName(scene) ? scene : 'foil'),
    demo.showEnvironment(isEnvironmentName(environment) ? environment : 'warehouse'),
  ])
  // The banner says why.
  if (!demo.isReady) return
  const form = byId('controls', HTMLFormElement)
  const panel = new Panel(form, demo)
  const explanation = new Explanation(() => demo.explain())
  form.append(explanation.element)
  const tabs = segments(byId('subjects', HTMLFieldSetElement), {
    options: SUBJECTS,
    get: () => demo.subjectName,
    set: (name) => void demo.showSubject(name),
  })
  const dock = new Dock((error) => {
    demo.banner.show(error)
  })
  dock.add(new Inspector(demo))
  dock.add(new DesignPanel(demo))
  demo.onChanged = () => {
    panel.refresh()
    tabs.refresh()
    showStatus(demo)
  }
  viewer.onSettled = () => {
    explanation.refresh()
  }
  demo.onChanged()
  if (foil !== null) await demo.showFoil(foil)
}
