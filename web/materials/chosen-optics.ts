import { DiffractionError } from '../errors.ts'
import { errorChoice } from '../lazy-code.ts'
import type { LoadedMap } from '../maps/load.ts'
import type { Feature, Optics, OpticsSettings, Surface } from '../surfaces/surface.ts'
import { oneOf, positive } from '../validation.ts'
import { OpticsLoader } from './optics-loader.ts'
import { CHOSEN_SETTINGS, DEFAULT_SETTINGS, SETTING_CHECKS } from './options.ts'

/** Who draws the optics. */
export interface OpticsUser {
  /** For errors: 'DiffractionMaterial'. */
  readonly name: string
  /** Takes over a surface, or what one has changed beyond its uniforms. */
  useSurface: (surface: Surface, isNew: boolean) => void
  /** Takes over optics whose tables are there. */
  useOptics: (optics: Optics) => void
  onError: (error: DiffractionError) => void
}

/** A surface and the settings under which it is drawn: as given, or chosen by the largest error that is wanted. */
export class ChosenOptics {
  readonly settings: OpticsSettings = { ...DEFAULT_SETTINGS }
  /** What was chosen, and why. */
  features: readonly Feature[] = []
  readonly #user: OpticsUser
  readonly #loader: OpticsLoader
  /** Names of the settings that were given; no choice touches them. */
  readonly #given = new Set<keyof OpticsSettings>()
  #maxError: number | null = null
  /** The settings of the optics in use; null before the first. */
  #applied: OpticsSettings | null = null
  #surface: Surface
  #surfaceVersion = -1
  /** False while one option is set after the other. */
  #isComplete = false

  constructor(
    user: OpticsUser,
    surface: Surface,
    readonly mapsPath: string,
    maps: Readonly<Record<string, LoadedMap>>,
  ) {
    this.#user = user
    this.#surface = surface
    this.#takeDefaults()
    this.#loader = new OpticsLoader(
      (optics) => {
        user.useOptics(optics)
        this.#applied = { ...this.settings }
      },
      (error) => {
        this.#fail(error)
      },
      maps,
    )
  }

  /** After the last of the first options. */
  begin(): void {
    this.#isComplete = true
    this.#request()
  }

  /** Resolves when all tables are there and in use; rejects with a DiffractionError. */
  get ready(): Promise<void> {
    this.follow()
    return this.#loader.ready
  }

  /** Names of the settings that were given; where `maxError` is, it chooses the others. */
  get given(): ReadonlySet<keyof OpticsSettings> {
    return this.#given
  }

  /** Maps that are taken in the place of what their addresses would fetch. */
  get maps(): Readonly<Record<string, LoadedMap>> {
    return this.#loader.maps
  }

  set maps(value: Readonly<Record<string, LoadedMap>>) {
    this.#loader.maps = value
  }

  get state(): OpticsLoader['state'] {
    return this.#loader.state
  }

  get error(): DiffractionError | null {
    return this.#loader.error
  }

  get isApplied(): boolean {
    return this.#applied !== null
  }

  get surface(): Surface {
    return this.#surface
  }

  set surface(value: Surface) {
    if (value === this.#surface) return
    this.#surface = value
    this.#takeDefaults()
    // The old surface's optics do not fit the new one's GLSL.
    this.#applied = null
    this.#user.useSurface(value, true)
    this.#request()
  }

  get maxError(): number | null {
    return this.#maxError
  }

  set maxError(value: number | null) {
    this.#maxError = value === null ? null : positive(this.#user.name, 'maxError', value, '')
    this.#request()
  }

  /** One of the optics' settings: taken if the surface can be shown with it, else as it was. */
  set<K extends keyof OpticsSettings>(name: K, value: OpticsSettings[K]): void {
    const checked = this.#checked(name, value)
    const wasGiven = this.#given.has(name)
    this.#given.add(name)
    if (checked === this.settings[name]) return
    const before = { ...this.settings }
    this.settings[name] = checked
    try {
      this.#request()
    } catch (error) {
      Object.assign(this.settings, before)
      if (!wasGiven) this.#given.delete(name)
      this.#choose()
      throw error
    }
  }

  /** Takes over what another was given, its surface and settings being here already. */
  copyGiven(from: ChosenOptics): void {
    this.#given.clear()
    for (const name of from.#given) this.#given.add(name)
    this.maxError = from.maxError
  }

  /** Takes over what a surface changed since the last look, in a frame or before `ready` is awaited. */
  follow(): void {
    if (this.#surface.version === this.#surfaceVersion) return
    this.#user.useSurface(this.#surface, false)
    this.#request()
  }

  /** Some settings are a question of what the surface offers. */
  #checked<K extends keyof OpticsSettings>(name: K, value: unknown): OpticsSettings[K] {
    const owner = this.#user.name
    const checked = SETTING_CHECKS[name](owner, value)
    if (name === 'method') oneOf(owner, name, value, this.#surface.methods)
    if (name === 'energy') oneOf(owner, name, value, this.#surface.energies)
    return checked
  }

  /** A method or energy that was not given, or that the surface does not have, gives way to its default. */
  #takeDefaults(): void {
    const { settings } = this
    const { methods, energies } = this.#surface
    if (!this.#isGiven('method', methods)) settings.method = methods[0]!
    if (!this.#isGiven('energy', energies)) settings.energy = energies[0]!
  }

  #isGiven(name: 'method' | 'energy', offered: readonly string[]): boolean {
    if (!offered.includes(this.settings[name])) this.#given.delete(name)
    return this.#given.has(name)
  }

  /** Chooses what was not given, if an error was; what it chose before goes with the error. */
  #choose(): void {
    const isChosen = this.features.length > 0
    this.features = []
    if (this.#maxError === null && !isChosen) return
    const defaults = { ...DEFAULT_SETTINGS, method: this.#surface.methods[0]! }
    const free = CHOSEN_SETTINGS.filter((name) => !this.#given.has(name))
    Object.assign(this.settings, Object.fromEntries(free.map((name) => [name, defaults[name]])))
    if (this.#maxError === null || errorChoice.code === null) return
    const { choiceForError } = errorChoice.code
    const choice = choiceForError(this.#surface, this.settings, this.#given, this.#maxError)
    Object.assign(this.settings, choice.settings)
    this.features = choice.features
  }

  #request(): void {
    if (!this.#isComplete) return
    this.#surfaceVersion = this.#surface.version
    if (this.#maxError !== null && errorChoice.code === null) {
      this.#loader.requestAfter(errorChoice.load(), () => {
        this.#request()
      })
      return
    }
    this.#choose()
    this.#loader.request(this.#surface, this.settings, this.mapsPath)
  }

  /** Tables did not come: back to the settings of those in use. */
  #fail(error: DiffractionError): void {
    if (this.#applied !== null) Object.assign(this.settings, this.#applied)
    this.#user.onError(error)
  }
}
