import { MathUtils } from 'three'
import { Foil, Grating, HeightField } from '../../web'
import { ERROR_SOURCES, type Demo, type ErrorSource } from '../demo'
import { adjust } from '../subjects/adjust'
import { ENVIRONMENTS } from '../light/environments'
import { bakedMethods, FIELDS, type FieldName } from '../subjects/fields'
import type { Subject } from '../subjects/subject'
import { choice, type ChoiceOptions } from './choice'
import { periodsSetting, strewnSetting } from '../link/designs'
import type { Setting } from '../link/setting'
import type { Control } from './control'
import { make } from './elements'
import { METHODS } from './methods'
import { foilField } from './foil-field'
import { property } from './property'
import { slider, type SliderOptions } from './slider'

const METALS = { aluminium: 'Aluminium', silver: 'Silver', gold: 'Gold', copper: 'Copper' } as const

const PROFILES = {
  sinusoidal: 'Sinusoidal',
  rectangular: 'Rectangular',
  triangular: 'Triangular',
  blazed: 'Blazed',
  sampled: 'Sampled',
}

const ILLUMINANTS = {
  D65: 'D65, daylight',
  A: 'A, incandescent',
  'inverse-A': 'Inverse A',
  'LED-B1': 'LED B1, 2733 K',
  'LED-B2': 'LED B2, 2998 K',
  'LED-B3': 'LED B3, 4103 K',
  'LED-B4': 'LED B4, 5109 K',
  'LED-B5': 'LED B5, 6598 K',
}

/** How many frames a picture at rest is the mean of. */
const FRAMES = { 1: '1', 2: '2', 4: '4', 8: '8', 16: '16', 32: '32', 64: '64' }

const { degToRad, radToDeg } = MathUtils

/** All controls, in groups that can be folded. */
export class Panel {
  /** The values that controls show, in the order in which they can be taken over. */
  readonly settings: Setting[] = []
  readonly #controls: Control[] = []

  constructor(
    private readonly form: HTMLFormElement,
    private readonly demo: Demo,
  ) {
    form.addEventListener('submit', (event) => {
      event.preventDefault()
    })
    this.#addSurface()
    this.#addSurroundings()
    this.#addFlash()
    this.#addMethod()
    this.refresh()
  }

  /** Shows all values as they are now. */
  refresh(): void {
    for (const control of this.#controls) control.refresh()
  }

  #addSurface(): void {
    const { demo } = this
    const surface = (): Subject['surface'] => demo.subject.surface
    const grating = (): Grating | undefined => only(surface(), Grating)
    const heightField = (): HeightField | undefined => only(surface(), HeightField)
    const profiled = (): Grating | Foil | undefined => grating() ?? only(surface(), Foil)
    /** Circles have no direction, and a foil's map states its own. */
    const directed = (): Grating | HeightField | undefined =>
      grating()?.tracks === 'circular' ? undefined : (grating() ?? heightField())
    const dielectric = (): HeightField | undefined =>
      heightField()?.ior === null ? undefined : heightField()
    const foil = foilField(demo)
    // In the order in which they are made of one another.
    this.settings.push(foil.setting, strewnSetting(demo), periodsSetting(demo))
    this.#group('Surface', true, [
      foil.choice,
      foil.address,
      this.#choice('relief', 'Relief', FIELDS, {
        // The material's: one that is on its way is the one that was chosen.
        get: () => only(demo.subject.material.surface, HeightField)?.field as FieldName | undefined,
        set: (value) => demo.showField(value),
      }),
      this.#slider({
        name: 'period',
        label: 'Period',
        unit: 'µm',
        ...{ min: 0.4, max: 6, step: 0.01 },
        ...property(grating, 'period'),
      }),
      this.#slider({
        name: 'height',
        label: 'Relief height',
        unit: 'µm',
        ...{ min: 0.01, max: 0.5, step: 0.005 },
        ...property(profiled, 'height'),
      }),
      this.#choice('profile', 'Profile', PROFILES, property(profiled, 'profile')),
      this.#degrees('orientation', 'Orientation', -180, 180, 1, property(directed, 'orientation')),
      this.#choice('metal', 'Metal', METALS, {
        get: () => (dielectric() === undefined ? demo.subject.material.metal : undefined),
        set: (value) => {
          adjust(demo.subject.material, { metal: value })
        },
      }),
      this.#slider({
        name: 'ior',
        label: 'Refractive index',
        unit: '',
        ...{ min: 1.05, max: 2.5, step: 0.01 },
        get: () => dielectric()?.ior ?? undefined,
        set: property(dielectric, 'ior').set,
      }),
      this.#degrees('roughness', 'Roughness (σ of tilt)', 0, 5, 0.05, {
        get: () => demo.subject.material.roughness,
        set: (value) => {
          adjust(demo.subject.material, { roughness: value })
        },
      }),
      this.#slider({
        name: 'coat',
        label: 'Clear coat',
        unit: '%',
        ...{ min: 0, max: 100, step: 1 },
        get: () => 100 * demo.subject.material.coat,
        set: (value) => (demo.subject.material.coat = value / 100),
      }),
      this.#degrees(
        'bend',
        'Bend',
        -120,
        120,
        1,
        property(() => demo.subject.sheet, 'angle'),
      ),
    ])
  }

  #addSurroundings(): void {
    const { demo } = this
    const { surroundings, viewer } = demo
    this.#group('Surroundings', true, [
      this.#choice(
        'environment',
        'Environment',
        { ...ENVIRONMENTS, none: 'None' },
        {
          get: () => surroundings.chosen,
          set: (value) => demo.showEnvironment(value),
        },
      ),
      this.#slider({
        name: 'brightness',
        label: 'Brightness',
        unit: '%',
        ...{ min: 0, max: 300, step: 5 },
        get: () => 100 * surroundings.brightness,
        set: (value) => (surroundings.brightness = value / 100),
      }),
      this.#degrees('turn', 'Turn', -180, 180, 1, {
        get: () => surroundings.turn,
        set: (value) => (surroundings.turn = value),
      }),
      this.#slider({
        name: 'exposure',
        label: 'Exposure',
        unit: 'EV',
        ...{ min: -4, max: 4, step: 0.1 },
        get: () => viewer.exposure,
        set: (value) => (viewer.exposure = value),
      }),
    ])
  }

  #addFlash(): void {
    const { flash } = this.demo
    this.#group('Flash', true, [
      this.#slider({
        name: 'flash',
        label: 'Intensity',
        unit: 'cd',
        ...{ min: 0, max: 20, step: 0.1 },
        get: () => flash.intensity,
        set: (value) => (flash.intensity = value),
      }),
      this.#degrees('flash-radius', 'Angular radius (σ)', 0.05, 5, 0.05, {
        get: () => flash.angularRadius,
        set: (value) => (flash.angularRadius = value),
      }),
      this.#degrees('flash-azimuth', 'Azimuth', -180, 180, 1, {
        get: () => flash.azimuth,
        set: (value) => (flash.azimuth = value),
      }),
      this.#degrees('flash-height', 'Height', -85, 85, 1, {
        get: () => flash.height,
        set: (value) => (flash.height = value),
      }),
    ])
  }

  #addMethod(): void {
    const { demo } = this
    this.#group('Light and method', false, [
      this.#choice('illuminant', 'Illuminant', ILLUMINANTS, {
        get: () => demo.subject.material.illuminant as keyof typeof ILLUMINANTS,
        set: (value) => {
          adjust(demo.subject.material, { illuminant: value })
        },
      }),
      this.#choice('method', 'Method', METHODS, {
        offered: () => bakedMethods(demo.subject.surface),
        get: () => demo.subject.material.method,
        set: (value) => {
          demo.subject.material.method = value
        },
      }),
      this.#slider({
        name: 'coherence',
        label: 'Coherence (σ of window)',
        unit: 'µm',
        ...{ min: 1, max: 60, step: 0.25 },
        get: () => demo.subject.material.coherence,
        set: (value) => {
          adjust(demo.subject.material, { coherence: value })
        },
      }),
      this.#choice<string>('frames', 'Frames at rest', FRAMES, {
        get: () => String(demo.viewer.frames),
        set: (value) => {
          demo.viewer.frames = Number(value)
        },
      }),
      this.#choice<ErrorSource>('error', 'Error beside the picture', ERROR_SOURCES, {
        get: () => demo.errorSource,
        set: (source) => {
          demo.errorSource = source
        },
      }),
    ])
  }

  #group(title: string, isOpen: boolean, controls: Control[]): void {
    const group = make('details', 'group', make('summary', '', title))
    group.open = isOpen
    group.append(...controls.map(({ element }) => element))
    this.form.append(group)
    this.#controls.push(...controls)
  }

  #slider(options: SliderOptions): Control {
    const control = slider(options, this.demo.attempt)
    this.settings.push(control.setting)
    return control
  }

  #choice<T extends string>(
    name: string,
    label: string,
    options: Readonly<Record<T, string>>,
    value: Omit<ChoiceOptions<T>, 'name' | 'label' | 'options'>,
  ): Control {
    const control = choice({ name, label, options, ...value }, this.demo.attempt)
    this.settings.push(control.setting)
    return control
  }

  /** A slider in degrees for a value in radians. */
  #degrees(
    name: string,
    label: string,
    min: number,
    max: number,
    step: number,
    { get, set }: { get: () => number | undefined; set: (value: number) => void },
  ): Control {
    return this.#slider({
      name,
      label,
      unit: '°',
      ...{ min, max, step },
      get: () => {
        const value = get()
        return value === undefined ? undefined : radToDeg(value)
      },
      set: (value) => {
        set(degToRad(value))
      },
    })
  }
}

/** The value, if it is of that class. */
function only<T>(value: unknown, kind: new (...options: never[]) => T): T | undefined {
  return value instanceof kind ? value : undefined
}
