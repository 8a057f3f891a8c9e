import { camera, renderer, scene } from './given'

/** Resolves when so many frames have been drawn: by the block, or else by this. */
export async function drawn(frames: number): Promise<void> {
  if (frames === 1) renderer.render(scene, camera)
  while (renderer.info.render.frame < frames) await new Promise(requestAnimationFrame)
  if (renderer.getContext().getError() !== 0) throw new Error('WebGL has an error')
}
