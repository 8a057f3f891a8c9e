import {
  MathUtils,
  NeutralToneMapping,
  PerspectiveCamera,
  Scene,
  SRGBColorSpace,
  WebGLRenderer,
} from 'three'
import { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import { ProgressiveRefinement } from '../../web'
import { MovingResolution } from './moving-resolution'

/** How long after the last change the picture is drawn in full resolution, ms. */
const REST_DELAY = 160

/** Vertical, °, in windows that are wide enough. */
const FIELD_OF_VIEW = 30
/** Factor on radiance at 0 EV. */
const BASE_EXPOSURE = 0.6

/** Draws the scene when something has changed: quickly while it moves, finely at rest, and then no more. */
export class Viewer {
  readonly scene = new Scene()
  readonly camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.05, 100)
  readonly orbit: OrbitControls
  readonly renderer: WebGLRenderer
  /** Called before each frame with the time since the last one, s; true asks for a further frame. */
  animate: (seconds: number) => boolean = () => false
  /** Called when the picture is finished. */
  onSettled: () => void = () => undefined
  onError: (error: unknown) => void = (error) => {
    console.error(error)
  }

  readonly #refinement: ProgressiveRefinement
  readonly #moving = new MovingResolution()
  #fittedAspect = 1
  #isRequested = false
  #isChanged = false
  #isMeanAtRest = false
  #lastFrame = 0
  #lastChange = 0

  constructor(
    private readonly canvas: HTMLCanvasElement,
    context: WebGL2RenderingContext,
  ) {
    this.renderer = new WebGLRenderer({ canvas, context })
    this.renderer.outputColorSpace = SRGBColorSpace
    // Of three's curves the one that keeps hue and chroma up to where it must compress.
    this.renderer.toneMapping = NeutralToneMapping
    this.renderer.autoClear = false
    this.renderer.debug.onShaderError = (gl, program, _vertex, fragment) => {
      const log = [gl.getProgramInfoLog(program), gl.getShaderInfoLog(fragment)].join('\n')
      this.onError(new Error(`This graphics device does not compile the shader: ${log}`))
    }
    this.renderer.setClearColor(0x0c0d10)
    this.exposure = 0
    canvas.addEventListener('webglcontextlost', () => {
      this.onError(new Error('The graphics device was reset; the picture returns when it does.'))
    })
    canvas.addEventListener('webglcontextrestored', () => {
      this.invalidate()
    })
    this.#refinement = new ProgressiveRefinement(this.renderer)
    this.orbit = new OrbitControls(this.camera, canvas)
    this.orbit.enablePan = false
    this.orbit.minDistance = 1.5
    this.orbit.maxDistance = 9
    this.orbit.addEventListener('change', () => {
      this.invalidate()
    })
    new ResizeObserver(() => {
      this.#resize()
      // A canvas of a new size is empty, and is shown before the next frame.
      this.#frame(performance.now())
    }).observe(canvas)
    this.#resize()
  }

  /** Exposure, EV. */
  get exposure(): number {
    return Math.log2(this.renderer.toneMappingExposure / BASE_EXPOSURE)
  }

  set exposure(value: number) {
    this.renderer.toneMappingExposure = BASE_EXPOSURE * 2 ** value
    this.invalidate()
  }

  /** Keeps a picture of that width over height in view, however narrow the window is. */
  fit(aspect: number): void {
    this.#fittedAspect = aspect
    this.#resize()
  }

  /** Says that the picture is no longer what it should be. */
  invalidate(): void {
    this.#isChanged = true
    this.canvas.dataset['state'] = 'moving'
    this.#request()
  }

  #request(): void {
    if (this.#isRequested) return
    this.#isRequested = true
    requestAnimationFrame((now) => {
      this.#isRequested = false
      this.#frame(now)
    })
  }

  #frame(now: number): void {
    // After a pause, an animation goes on where it was.
    const seconds = Math.min((now - this.#lastFrame) / 1000, 0.1)
    this.#lastFrame = now
    if (this.animate(seconds)) this.invalidate()
    this.orbit.update()
    try {
      this.#draw(now)
    } catch (error) {
      // The canvas keeps what it shows.
      this.renderer.setRenderTarget(null)
      this.#settle()
      this.onError(error)
    }
  }

  #draw(now: number): void {
    if (this.#isChanged) {
      this.#isChanged = false
      this.#isMeanAtRest = false
      this.#lastChange = now
      this.#moving.frame(now)
      this.#begin(this.#moving.scale)
      this.#refine()
      this.#request()
      return
    }
    if (now - this.#lastChange < REST_DELAY) {
      this.#request()
      return
    }
    if (!this.#isMeanAtRest) {
      this.#isMeanAtRest = true
      this.canvas.dataset['state'] = 'refining'
      this.#begin(1)
    }
    if (this.#refine()) this.#request()
    else this.#settle()
  }

  #begin(scale: number): void {
    const { width, height } = this.canvas
    this.#refinement.begin(
      Math.max(Math.round(width * scale), 1),
      Math.max(Math.round(height * scale), 1),
    )
  }

  /** Returns whether the picture needs further frames. */
  #refine(): boolean {
    const needsMore = this.#refinement.frame(this.scene, this.camera)
    this.#refinement.show()
    return needsMore
  }

  #settle(): void {
    this.canvas.dataset['state'] = 'settled'
    this.onSettled()
  }

  #resize(): void {
    const { clientWidth, clientHeight } = this.canvas
    if (clientWidth === 0 || clientHeight === 0) return
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2))
    this.renderer.setSize(clientWidth, clientHeight, false)
    this.camera.aspect = clientWidth / clientHeight
    // In a narrow window the width is what the object has to fit into.
    const narrow = Math.max(this.#fittedAspect / this.camera.aspect, 1)
    const halfHeight = Math.tan(MathUtils.degToRad(FIELD_OF_VIEW / 2))
    this.camera.fov = MathUtils.radToDeg(2 * Math.atan(halfHeight * narrow))
    this.camera.updateProjectionMatrix()
    this.invalidate()
  }
}
