import { Vector2, Vector3 } from 'three'
import { Foil, Grating, HeightField } from '../../web'
import { bitByBit, type Steps } from '../../web/steps'
import type { Demo } from '../demo'
import type { ToolContents } from '../tools/dock'
import { byId, make } from '../ui/elements'
import '../style/plots.css'
import '../style/inspector.css'
import { Crosshair } from './crosshair'
import { spectralColours } from './optics/display'
import type { Colour } from './optics/light-spectrum'
import { frameOf, pickAt, pointAtUv, type PickedPoint } from './picked-point'
import { EnvironmentArcs } from './pictures/environment-arcs'
import { Facts } from './pictures/facts'
import { Lobes } from './pictures/lobes'
import { OrientationMap } from './pictures/orientation-map'
import { ReliefLines } from './pictures/relief-lines'
import { Spectra } from './pictures/spectra'
import { TablePictures } from './pictures/tables'
import { loadTables, type SpectralTables } from './point-optics'
import { environmentRadiance, flashRadiance } from './radiance'
import { RenderedPixel } from './rendered-pixel'
import { environmentLight, opticsAt } from './scene-light'

/** While things move the pictures follow as often as this, ms. */
const INTERVAL = 150
/** Rings and steps of places that are tried for a first point. */
const RINGS = 12
const STEPS = 16

/** The pictures of the inspector, and the point that they are of. */
export class InspectorContents implements ToolContents {
  readonly element = make('div', 'inspector')
  readonly #crosshair = new Crosshair((x, y) => {
    this.#pickAt(x, y)
  })
  readonly #facts = new Facts()
  readonly #map = new OrientationMap((u, v) => {
    this.#pickUv(u, v)
  })
  readonly #lobes = new Lobes()
  readonly #lines = new ReliefLines()
  readonly #arcs = new EnvironmentArcs()
  readonly #spectra = new Spectra()
  readonly #tablePictures = new TablePictures()
  readonly #pixel: RenderedPixel
  readonly #canvas = byId('view', HTMLCanvasElement)

  #isOpen = false
  #point: PickedPoint | null = null
  #tables: SpectralTables | null = null
  #tablesKey = ''
  #colours: readonly Colour[] = []
  /** What the last pictures were made from. */
  #shown = ''
  #shownAt = 0
  #isDrawing = false
  #isSearching = false
  #rendered = ''

  constructor(private readonly demo: Demo) {
    this.#pixel = new RenderedPixel(demo)
    const blocks = [
      this.#map.block,
      this.#lobes.block,
      this.#lines.block,
      this.#arcs.block,
      this.#spectra.block,
      ...this.#tablePictures.blocks,
    ]
    this.element.append(this.#facts.element, ...blocks.map(({ element }) => element))
    for (const { element } of blocks)
      element.addEventListener('toggle', () => {
        this.#shown = ''
      })
  }

  open(): void {
    this.#isOpen = true
    this.#shown = ''
    this.#crosshair.show()
    this.#follow()
  }

  close(): void {
    this.#isOpen = false
    this.#crosshair.hide()
  }

  /** Looks at each frame whether something has changed; draws only then. */
  #follow(): void {
    if (!this.#isOpen) return
    requestAnimationFrame((now) => {
      if (!this.#isOpen) return
      this.#frame(now)
      this.#follow()
    })
  }

  #frame(now: number): void {
    const { subject } = this.demo
    if (this.#tablesKey !== tablesKey(this.demo)) void this.#loadTables()
    if (this.#point !== null && !isWithin(this.#point, subject.object)) this.#point = null
    if (this.#point === null) {
      this.#search()
      return
    }
    this.#moveCrosshair(this.#point)
    if (this.#tables === null) return
    const state = this.#state()
    if (state !== this.#shown && now - this.#shownAt >= INTERVAL && !this.#isDrawing) {
      this.#shown = state
      this.#shownAt = now
      this.#isDrawing = true
      void bitByBit(this.#draw(this.#point, this.#tables)).finally(() => {
        this.#isDrawing = false
      })
    }
    const { state: picture, pictures } = this.#canvas.dataset
    // Some settings reach the picture later than the state.
    const rendered = `${state} ${pictures}`
    if (picture !== 'settled' || this.#isDrawing || this.#shown !== state) return
    if (this.#rendered === rendered) return
    this.#rendered = rendered
    void this.#compare(this.#point, this.#tables, rendered)
  }

  /** Picture by picture, so that none keeps the page waiting for all. */
  *#draw(point: PickedPoint, tables: SpectralTables): Steps<void> {
    const optics = opticsAt(this.demo, tables, point)
    const exposure = this.demo.viewer.renderer.toneMappingExposure
    const light = environmentLight(this.demo)
    this.#facts.show(optics)
    void this.#map.show(optics)
    yield
    this.#lobes.show(optics, this.#colours)
    yield
    yield* this.#lines.show(optics, this.#colours)
    yield
    yield* this.#arcs.show(optics, light, exposure, this.#colours)
    yield
    const flash = flashRadiance(optics)
    yield
    const environment = light && (yield* environmentRadiance(optics, light))
    yield
    this.#spectra.show(optics, flash, environment, this.#colours)
    this.#spectra.compare(flash, environment, null, exposure)
    this.#tablePictures.show(tables)
  }

  async #compare(point: PickedPoint, tables: SpectralTables, key: string): Promise<void> {
    if (!this.#spectra.block.isOpen) return
    const { camera, renderer } = this.demo.viewer
    const { subject } = this.demo
    const { position } = frameOf(point, camera.position)
    const { x, y } = this.#project(position)
    // A lobe may end within a pixel: what is compared is the middle of the one that the point lies in.
    const { width, height } = renderer.domElement
    const pixel = { column: Math.floor(x * width), row: Math.floor(y * height) }
    const middle = new Vector2(
      (2 * (pixel.column + 0.5)) / width - 1,
      1 - (2 * (pixel.row + 0.5)) / height,
    )
    const at = pickAt(middle, camera, subject.object, subject.material) ?? point
    const optics = opticsAt(this.demo, tables, at)
    const rendered = await this.#pixel.read(pixel)
    if (this.#rendered !== key) return
    const exposure = this.demo.viewer.renderer.toneMappingExposure
    const light = environmentLight(this.demo)
    const environment = light && (await bitByBit(environmentRadiance(optics, light)))
    if (this.#rendered !== key) return
    this.#spectra.compare(flashRadiance(optics), environment, rendered, exposure)
  }

  async #loadTables(): Promise<void> {
    const key = tablesKey(this.demo)
    this.#tablesKey = key
    this.#tables = null
    try {
      const tables = await loadTables(this.demo.subject)
      if (this.#tablesKey !== key) return
      this.#tables = tables
      this.#colours = spectralColours(tables.spectrum)
      this.#shown = ''
    } catch (error) {
      this.demo.banner.show(error)
    }
  }

  #pickAt(x: number, y: number): void {
    const { viewer, subject } = this.demo
    const place = new Vector2(2 * x - 1, 1 - 2 * y)
    this.#point = pickAt(place, viewer.camera, subject.object, subject.material) ?? this.#point
  }

  #pickUv(u: number, v: number): void {
    if (this.#point !== null) this.#point = pointAtUv(this.#point, new Vector2(u, v)) ?? this.#point
  }

  /** Picks the point that is nearest to the middle of the view. */
  #search(): void {
    if (this.#isSearching) return
    this.#isSearching = true
    void bitByBit(this.#pickFirst()).finally(() => {
      this.#isSearching = false
    })
  }

  /** Place by place: an object of many parts takes long at each. */
  *#pickFirst(): Steps<void> {
    for (let ring = 0; ring < RINGS; ring++) {
      const radius = (0.45 * ring) / RINGS
      for (let step = 0; step < (ring === 0 ? 1 : STEPS); step++) {
        const angle = (2 * Math.PI * step) / STEPS
        this.#pickAt(0.5 + radius * Math.cos(angle), 0.5 + radius * Math.sin(angle))
        yield
        if (this.#point !== null || !this.#isOpen) return
      }
    }
  }

  #moveCrosshair(point: PickedPoint): void {
    const eye = this.demo.viewer.camera.getWorldPosition(new Vector3())
    const { position, normal } = frameOf(point, eye)
    const { x, y } = this.#project(position)
    this.#crosshair.move(x, y, eye.sub(position).dot(normal) > 0)
  }

  /** From the view's left and top, 0 to 1. */
  #project(position: Vector3): { x: number; y: number } {
    const { x, y } = position.clone().project(this.demo.viewer.camera)
    return { x: (x + 1) / 2, y: (1 - y) / 2 }
  }

  /** All that the pictures depend on. */
  #state(): string {
    const { subject, flash, viewer } = this.demo
    const { material, surface } = subject
    const { camera, scene, renderer } = viewer
    const point = this.#point!
    return [
      this.#tablesKey,
      ...camera.matrixWorld.elements,
      ...camera.projectionMatrix.elements,
      ...frameOf(point, camera.position).position.toArray(),
      ...point.mesh.matrixWorld.elements,
      ...point.uv.toArray(),
      ...flash.object.position.toArray(),
      flash.intensity,
      flash.angularRadius,
      ...[material.roughness, material.coherence, material.coat, material.coatIor, material.energy],
      ...surfaceState(surface),
      ...[this.demo.surroundings.chosen, scene.environmentIntensity, scene.environmentRotation.y],
      renderer.toneMappingExposure,
    ].join()
  }
}

function surfaceState(surface: Foil | Grating | HeightField): unknown[] {
  if (surface instanceof Foil) return [surface.height, surface.map.url, surface.repeat.toArray()]
  if (surface instanceof Grating)
    return [surface.height, surface.period, surface.orientation, surface.tracks, surface.strength]
  return [surface.orientation, surface.strength, surface.ior]
}

/** What decides which tables are read. */
function tablesKey({ subject, subjectName }: Demo): string {
  const { surface, material } = subject
  const own = surface instanceof HeightField ? surface.field : surface.profile
  return [subjectName, material.metal, material.illuminant, material.observer, own].join()
}

function isWithin({ mesh }: PickedPoint, object: object): boolean {
  for (let parent: object | null = mesh; parent !== null; parent = (parent as typeof mesh).parent)
    if (parent === object) return true
  return false
}
