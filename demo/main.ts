import { Demo } from './demo'
import { isEnvironmentName } from './light/environments'
import { Dock } from './tools/dock'
import { tools } from './tools/tools'
import { keepOffline } from './offline/keep-offline'
import { follow } from './link/link'
import { cameraSetting, tiltSetting } from './link/poses'
import { choiceSetting } from './link/setting'
import { isSubjectName, SUBJECTS, type SubjectName } from './subjects'
import { Actions } from './ui/actions'
import { divider } from './ui/divider'
import { byId } from './ui/elements'
import { Explanation } from './ui/explanation'
import { Facts } from './ui/facts'
import { Panel } from './ui/panel'
import { segments } from './ui/segments'
import { showStatus } from './ui/status'
import { keepSheet } from './ui/sheet'
import { requireContext, UnsupportedError } from './view/capabilities'
import { DRAG_MODES, listenToDrags, type DragMode } from './view/drag'
import { listenToKeys } from './view/keys'
import { Viewer } from './view/viewer'

const canvas = byId('view', HTMLCanvasElement)

/** `?scene=disc&environment=night&foil=ADDRESS` and more: what "Share" writes. */
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
  const tabs = segments(byId('subjects', HTMLFieldSetElement), {
    options: SUBJECTS,
    get: () => demo.subjectName,
    set: (name) => void demo.showSubject(name),
  })
  // What is shown before it is filled would be seen to move.
  byId('actions', HTMLDivElement).hidden = false

  const scene = parameters.get('scene')
  const environment = parameters.get('environment')
  // What is none of these is refused below, with all the rest.
  await Promise.all([
    demo.showSubject(isSubjectName(scene) ? scene : 'card'),
    demo.showEnvironment(isEnvironmentName(environment) ? environment : 'warehouse'),
  ])
  // The banner says why.
  if (!demo.isReady) return
  const form = byId('controls', HTMLFormElement)
  const panel = new Panel(form, demo)
  const explanation = new Explanation(() => demo.explain())
  form.append(explanation.element)
  byId('remarks', HTMLElement).hidden = false
  const dock = new Dock((error) => {
    demo.banner.show(error)
  })
  for (const tool of tools(demo)) dock.add(tool)
  const settings = [
    choiceSetting('scene', {
      words: () => Object.keys(SUBJECTS) as SubjectName[],
      get: () => demo.subjectName,
      set: (name) => demo.showSubject(name),
    }),
    ...panel.settings,
    tiltSetting(demo.tilt),
    cameraSetting(viewer),
  ]
  new Actions(demo, settings)
  const facts = new Facts(demo)
  const line = divider(demo.comparison)
  demo.onChanged = () => {
    panel.refresh()
    tabs.refresh()
    line.refresh()
    dock.refresh()
    showStatus(demo)
  }
  viewer.onSettled = () => {
    explanation.refresh()
    facts.refresh()
  }
  await demo.tell(follow(parameters, settings))
  demo.onChanged()
  viewer.invalidate()
  // Not before what is seen at first is there.
  keepOffline()
}
