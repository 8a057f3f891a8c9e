import type { Feature } from '../web'
import { DiffractionError, Foil, HeightField } from '../web'
import { Comparison } from './compare/comparison'
import { Designs } from './design/designs'
import { ENVIRONMENTS, type EnvironmentName } from './light/environments'
import { Flash } from './light/flash'
import { Surroundings } from './light/surroundings'
import { loadSubject, SUBJECTS, type SubjectName } from './subjects'
import { bakedMethods, FIELDS, type FieldName } from './subjects/fields'
import { loadFoil } from './subjects/foils'
import type { Subject } from './subjects/subject'
import { Banner } from './ui/banner'
import { Loading } from './ui/loading'
import { Tilt } from './view/tilt'
import type { Viewer } from './view/viewer'

/** What the error beside the picture is taken from. */
export const ERROR_SOURCES = { view: 'Measured in this view', report: 'The report’s' } as const
export type ErrorSource = keyof typeof ERROR_SOURCES

/** What the page shows, and the ways in which it can be changed. */
export class Demo {
  readonly flash = new Flash()
  readonly tilt = new Tilt()
  readonly surroundings: Surroundings
  readonly comparison: Comparison
  readonly banner = new Banner()
  readonly loading = new Loading()
  readonly designs = new Designs(this)
  errorSource: ErrorSource = 'view'
  /** Called when values have changed by other ways than their controls. */
  onChanged: () => void = () => undefined

  #subject: Subject | null = null
  #subjectName: SubjectName = 'card'

  constructor(readonly viewer: Viewer) {
    this.surroundings = new Surroundings(viewer.scene)
    this.comparison = new Comparison(viewer, (error) => {
      this.#refuse(error)
    })
    this.flash.intensity = 2
    viewer.scene.add(this.flash.object)
    viewer.animate = (seconds) => this.tilt.advance(seconds)
    viewer.onError = (error) => {
      this.#refuse(error)
    }
  }

  /** Whether the first object is there. */
  get isReady(): boolean {
    return this.#subject !== null
  }

  /** Address of the map of the foil on show; empty where there is none. */
  get foilUrl(): string {
    const { surface } = this.subject
    return surface instanceof Foil ? surface.map.url : ''
  }

  /** The object on show. */
  get subject(): Subject {
    if (this.#subject === null) throw new Error('The first object is not loaded yet')
    return this.#subject
  }

  get subjectName(): SubjectName {
    return this.#subjectName
  }

  /** Carries out a change; one that is refused leaves everything as it was, and says why. */
  readonly attempt = (change: () => void): void => {
    try {
      change()
      this.banner.hide()
      // Tables that must be fetched show when they are there. Their failure comes by the material's onError.
      this.subject.material.ready.then(
        () => {
          this.viewer.invalidate()
        },
        () => undefined,
      )
    } catch (error) {
      this.#refuse(error)
    }
    this.viewer.invalidate()
  }

  /**
   * Says how a task went: if it fails, why; if not, what is given. Returns what it results in, undefined where it
   * failed.
   */
  async tell<T>(task: Promise<T>, done = ''): Promise<T | undefined> {
    try {
      const result = await task
      if (done !== '') this.banner.note(done)
      return result
    } catch (error) {
      this.#refuse(error)
      return undefined
    }
  }

  async showSubject(name: SubjectName): Promise<void> {
    this.designs.stop()
    this.#subjectName = name
    await this.#load(`the ${SUBJECTS[name].toLowerCase()} and its tables`, async () => {
      const subject = await loadSubject(name)
      if (this.#subjectName === name && subject !== this.#subject) this.#take(subject)
    })
    this.onChanged()
  }

  async showEnvironment(name: EnvironmentName | 'none'): Promise<void> {
    const what = name === 'none' ? 'nothing' : ENVIRONMENTS[name]
    await this.#load(what, () => this.surroundings.choose(name))
    this.onChanged()
  }

  /** Covers the object on show with another foil; rejects where its map is broken. */
  async showFoil(url: string): Promise<void> {
    this.designs.stop()
    const { subject, loading } = this
    const { repeat } = subject
    if (repeat === undefined) return
    await loading.track('Loading the foil …', async () => {
      await this.#cover(subject, await loadFoil(url, repeat))
    })
    this.onChanged()
  }

  /** Covers an object with a foil that was made in the page; rejects where it cannot be drawn. */
  async showMadeFoil(subject: Subject, foil: Foil): Promise<void> {
    await this.#cover(subject, foil)
    this.onChanged()
  }

  /** Gives the object on show another height field, unless its maps are broken. */
  async showField(field: FieldName): Promise<void> {
    const { subject } = this
    const { surface, material } = subject
    if (!(surface instanceof HeightField)) return
    const { orientation, strength, ior } = surface
    await this.#load(FIELDS[field], async () => {
      const other = new HeightField({ field, orientation, strength, ior })
      const methods = bakedMethods(other)
      // A baked pattern has the reflectance in it, of this field or of another.
      if (material.method === 'baked' || !methods.includes(material.method))
        material.method = methods[0]!
      await this.#cover(subject, other)
    })
    this.onChanged()
  }

  explain(): Feature[] {
    return this.subject.material.explain()
  }

  async #cover(subject: Subject, surface: Subject['surface']): Promise<void> {
    const { material } = subject
    material.surface = surface
    try {
      await material.ready
    } catch (error) {
      // Another one may have been chosen by then.
      if (material.surface === surface) material.surface = subject.surface
      throw error
    } finally {
      this.viewer.invalidate()
    }
    subject.surface = surface
    this.banner.hide()
  }

  #take(subject: Subject): void {
    const before = this.#subject
    if (before !== null) this.viewer.scene.remove(before.object)
    this.#subject = subject
    subject.material.onError = (error) => {
      this.#refuse(error)
    }
    this.viewer.scene.add(subject.object)
    if (this.comparison.isOn) this.comparison.compare(subject)
    this.tilt.hold(subject.object, subject.tilt)
    this.flash.azimuth = subject.flash.azimuth
    this.flash.height = subject.flash.height
    this.flash.intensity = subject.light?.flash ?? 2
    this.viewer.exposure = subject.light?.exposure ?? 0
    this.viewer.fit(subject.aspect)
    this.viewer.camera.position.set(...subject.camera)
    this.viewer.orbit.update()
  }

  async #load(what: string, task: () => Promise<void>): Promise<void> {
    try {
      await this.loading.track(`Loading ${what} …`, task)
    } catch (error) {
      this.#refuse(error)
    }
    this.viewer.invalidate()
  }

  #refuse(error: unknown): void {
    this.banner.show(error)
    // Bad input is for whoever gave it, and the banner says all of it; anything else is a defect to be looked into.
    if (!(error instanceof DiffractionError)) console.error(error)
    this.onChanged()
  }
}
