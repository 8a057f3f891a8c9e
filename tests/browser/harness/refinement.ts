import { FloatType, WebGLRenderTarget, WebGLRenderer } from 'three'
import { ProgressiveRefinement } from '../../../web'
import { buildScene } from './build-scene'
import type { SceneDescription } from './scene-description'

/** What a page sees that refines a scene at rest, changes it, and lets it rest again. */
export interface RefinementReport {
  /** What each call of `frame` answered, two after the last that was needed. */
  answers: boolean[]
  /** Times the scene was drawn by those two. */
  drawnAfterwards: number
  /** Programs linked and textures written in frames after the second: two means take turns. */
  linked: number
  uploaded: number
  /** Largest difference over the largest radiance: of the scene refined a second time, */
  again: number
  /** of it turned, */
  turned: number
  /** of it turned back, */
  back: number
  /** of frames that stand alone, before and after a refinement. */
  alone: number
  /** Largest change of the camera's projection. */
  projection: number
}

/** Frames of each refinement. */
const FRAMES = 4

/** Refines a scene several times over. */
export async function reportRefinement(description: SceneDescription): Promise<RefinementReport> {
  const { scene, camera, mesh, dispose } = await buildScene(description)
  const renderer = new WebGLRenderer()
  const work = countWork(renderer)
  const [width, height] = description.size
  const projection = camera.projectionMatrix.toArray()
  const refinement = new ProgressiveRefinement(renderer, { frames: FRAMES })
  const target = new WebGLRenderTarget(width, height, { type: FloatType })
  const alone = (): Float32Array => {
    renderer.setRenderTarget(target)
    renderer.clear()
    renderer.render(scene, camera)
    renderer.setRenderTarget(null)
    return pixelsOf(renderer, target)
  }
  const refined = (): Float32Array => {
    refinement.begin(width, height)
    while (refinement.frame(scene, camera));
    return pixelsOf(renderer, refinement.mean)
  }

  const aloneBefore = alone()
  refinement.begin(width, height)
  const answers = [refinement.frame(scene, camera), refinement.frame(scene, camera)]
  Object.assign(work, { linked: 0, uploaded: 0 })
  while (answers.length < FRAMES) answers.push(refinement.frame(scene, camera))
  const { linked, uploaded } = work
  const drawn = renderer.info.render.frame
  answers.push(refinement.frame(scene, camera), refinement.frame(scene, camera))
  const drawnAfterwards = renderer.info.render.frame - drawn

  const first = pixelsOf(renderer, refinement.mean)
  const again = difference(first, refined())
  mesh.rotateY(0.2)
  const turned = difference(first, refined())
  mesh.rotateY(-0.2)
  const back = difference(first, refined())
  const report = {
    answers,
    drawnAfterwards,
    linked,
    uploaded,
    again,
    turned,
    back,
    alone: difference(aloneBefore, alone()),
    projection: difference(projection, camera.projectionMatrix.elements),
  }
  refinement.dispose()
  target.dispose()
  dispose()
  renderer.dispose()
  renderer.forceContextLoss()
  return report
}

/** Counts what WebGL is asked to link and to write into textures from now on. */
function countWork(renderer: WebGLRenderer): { linked: number; uploaded: number } {
  const work = { linked: 0, uploaded: 0 }
  const gl = renderer.getContext() as WebGL2RenderingContext
  const count = (
    name: 'linkProgram' | 'texImage2D' | 'texSubImage2D',
    kind: keyof typeof work,
  ): void => {
    const call = gl[name].bind(gl) as (...values: unknown[]) => void
    Object.assign(gl, {
      [name]: (...values: unknown[]) => {
        work[kind]++
        call(...values)
      },
    })
  }
  count('linkProgram', 'linked')
  count('texImage2D', 'uploaded')
  count('texSubImage2D', 'uploaded')
  return work
}

function pixelsOf(renderer: WebGLRenderer, target: WebGLRenderTarget): Float32Array {
  const { width, height } = target
  const pixels = new Float32Array(4 * width * height)
  renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels)
  return pixels
}

function difference(a: ArrayLike<number>, b: ArrayLike<number>): number {
  let [most, largest] = [0, 0]
  for (let i = 0; i < a.length; i++) {
    most = Math.max(most, Math.abs(a[i]! - b[i]!))
    largest = Math.max(largest, Math.abs(a[i]!))
  }
  return most / largest
}
