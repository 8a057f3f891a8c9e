import type { WebGLRenderTarget } from 'three'
import { MARKER_LAYER } from '../light/flash'
import type { Viewer } from '../view/viewer'

/** A way to draw the scene, that calls `render` once. */
export type Way = (render: () => void) => void

/**
 * Draws linear radiance into a target's viewport, over what is there, with coverage as alpha: 0 where no object is.
 * Neither the background nor the flash' mark are drawn.
 */
export function drawRadiance(
  { renderer, scene, camera }: Viewer,
  target: WebGLRenderTarget,
  way: Way,
): void {
  const { background } = scene
  const clearAlpha = renderer.getClearAlpha()
  scene.background = null
  camera.layers.disable(MARKER_LAYER)
  renderer.setClearAlpha(0)
  renderer.setRenderTarget(target)
  try {
    way(() => {
      renderer.clear()
      renderer.render(scene, camera)
    })
  } finally {
    renderer.setRenderTarget(null)
    renderer.setClearAlpha(clearAlpha)
    scene.background = background
    camera.layers.enable(MARKER_LAYER)
  }
}
