import {
  FloatType,
  MathUtils,
  NeutralToneMapping,
  PerspectiveCamera,
  Scene,
  SRGBColorSpace,
  WebGLRenderer,
} from 'three'
import { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import { ProgressiveRefinement } from '../../web'
import { MARKER_LAYER } from '../light/flash'
import { MovingResolution } from './moving-resolution'
import { WHOLE, type Pane } from './pane'

/** How long after the last change the picture is drawn in full resolution, ms. */
const REST_DELAY = 160

/** Vertical, °, in windows that are wide enough. */
const FIELD_OF_VIEW = 30
/** Factor on radiance at 0 EV. */
const BASE_EXPOSURE = 0.6

interface PaneDrawing {
  pane: Pane
  refinement: ProgressiveRefinement
  time: number
}

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

  #frames = 16
  #panes: readonly PaneDrawing[] = []
  readonly #moving = new MovingResolution()
  #fittedAspect = 1
  #isRequested = false
  #isChanged = false
  #isMeanAtRest = false
  #lastFrame = 0
  #lastChange = 0
  /** How many pictures have been finished. */
  #finished = 0

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
    this.#panes = this.#drawings([WHOLE])
    this.camera.layers.enable(MARKER_LAYER)
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

  /** What the picture is put together of, from the left to the right. */
  get panes(): readonly Pane[] {
    return this.#panes.map(({ pane }) => pane)
  }

  set panes(panes: readonly Pane[]) {
    for (const { refinement } of this.#panes.slice(panes.length)) refinement.dispose()
    this.#panes = this.#drawings(panes)
    this.invalidate()
  }

  /** How many frames a picture at rest is the mean of: a power of 2. */
  get frames(): number {
    return this.#frames
  }

  set frames(value: number) {
    this.#frames = value
    const panes = this.panes
    this.panes = []
    this.panes = panes
  }

  /** Whether the picture is finished. */
  get isSettled(): boolean {
    return this.canvas.dataset['state'] === 'settled'
  }

  /** How long a frame of each pane takes in full resolution, ms; the least that was measured of this picture. */
  get frameTimes(): readonly number[] {
    return this.#panes.map(({ time }) => time)
  }

  /** What the canvas shows, as a PNG file. */
  picture(): Promise<Blob> {
    // A canvas may be emptied once it has been shown: what is read has to be drawn in the same task.
    for (const drawing of this.#panes) this.#show(drawing)
    return new Promise((resolve, reject) => {
      this.canvas.toBlob((blob) => {
        if (blob === null) reject(new Error('This browser made no picture of the view'))
        else resolve(blob)
      })
    })
  }

  #drawings(panes: readonly Pane[]): PaneDrawing[] {
    return panes.map((pane, i) => ({
      pane,
      refinement:
        this.#panes[i]?.refinement ??
        new ProgressiveRefinement(this.renderer, { frames: this.#frames }),
      time: Infinity,
    }))
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
    for (const drawing of this.#panes) {
      const { width, height } = this.#bounds(drawing.pane)
      drawing.refinement.begin(
        Math.max(Math.round(width * scale), 1),
        Math.max(Math.round(height * scale), 1),
      )
      drawing.time = Infinity
    }
  }

  /** Returns whether the picture needs further frames. */
  #refine(): boolean {
    let needsMore = false
    for (const drawing of this.#panes) {
      const { refinement, pane } = drawing
      if (refinement.count === refinement.frames) continue
      const { x, width, height } = this.#bounds(pane)
      const start = performance.now()
      this.camera.setViewOffset(this.canvas.width, height, x, 0, width, height)
      pane.draw(() => {
        if (refinement.frame(this.scene, this.camera)) needsMore = true
      })
      this.camera.clearViewOffset()
      if (this.#isMeanAtRest) {
        this.#finish(refinement)
        drawing.time = Math.min(drawing.time, performance.now() - start)
      }
      this.#show(drawing)
    }
    return needsMore
  }

  /** Waits until a frame is drawn: reading a pixel of it cannot be answered before. */
  #finish({ mean }: ProgressiveRefinement): void {
    const pixel = mean.texture.type === FloatType ? new Float32Array(4) : new Uint16Array(4)
    this.renderer.readRenderTargetPixels(mean, 0, 0, 1, 1, pixel)
  }

  #show({ pane, refinement }: PaneDrawing): void {
    const ratio = this.renderer.getPixelRatio()
    const { x, width, height } = this.#bounds(pane)
    this.renderer.setViewport(x / ratio, 0, width / ratio, height / ratio)
    refinement.show()
  }

  /** Bounds in pixels of the canvas. */
  #bounds({ left, right }: Pane): { x: number; width: number; height: number } {
    const { width, height } = this.canvas
    const x = Math.round(left * width)
    return { x, width: Math.max(Math.round(right * width) - x, 1), height }
  }

  #settle(): void {
    this.canvas.dataset['state'] = 'settled'
    this.canvas.dataset['pictures'] = String(++this.#finished)
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
