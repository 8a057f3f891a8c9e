import type { Camera, Object3D, WebGLRenderer } from 'three'
import { angularRadius } from '../validation.ts'
import { isTinted, LightOrder } from './light-order.ts'

/** The lights of one scene in one frame, shared by all materials that are drawn in it. */
export interface SceneLights {
  /** Standard deviations of the lights' Gaussian discs, rad; NaN where the material's own applies. */
  angularRadii: number[]
  /** Whether any light's colour differs from grey. */
  isTinted: boolean
}

interface Entry extends SceneLights {
  order: LightOrder
  renderer: WebGLRenderer | null
  camera: Camera | null
  frame: number
}

const scenes = new WeakMap<Object3D, Entry>()

/** Looks at a scene's lights once a frame, camera and renderer. */
export function sceneLights(renderer: WebGLRenderer, scene: Object3D, camera: Camera): SceneLights {
  let entry = scenes.get(scene)
  if (entry === undefined) {
    entry = {
      angularRadii: [],
      isTinted: false,
      order: new LightOrder(),
      renderer: null,
      camera: null,
      frame: -1,
    }
    scenes.set(scene, entry)
  }
  const { frame } = renderer.info.render
  if (entry.frame !== frame || entry.camera !== camera || entry.renderer !== renderer) {
    entry.frame = frame
    entry.camera = camera
    entry.renderer = renderer
    read(entry, scene, camera)
  }
  return entry
}

function read(entry: Entry, scene: Object3D, camera: Camera): void {
  entry.order.update(scene, camera)
  const { lights } = entry.order
  entry.angularRadii.length = lights.length
  entry.isTinted = false
  for (let i = 0; i < lights.length; i++) {
    const light = lights[i]!
    const radius = (light.userData as { angularRadius?: unknown }).angularRadius
    entry.angularRadii[i] =
      radius === undefined
        ? NaN
        : angularRadius(light.name || light.type, 'userData.angularRadius', radius)
    entry.isTinted ||= isTinted(light)
  }
}
