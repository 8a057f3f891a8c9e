import { MathUtils } from 'three'
import { Foil, Grating, HeightField, type Method } from '../../web'
import type { Demo } from '../demo'
import { adjust } from '../subjects/adjust'
import { ENVIRONMENTS } from '../light/environments'
import { bakedMethods, FIELDS, type FieldName } from '../subjects/fields'
import { FOILS } from '../subjects/foils'
import type { Subject } from '../subjects/subject'
import { choice, type ChoiceOptions } from './choice'
import type { Control } from './control'
import { make } from './elements'
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

const METHODS: Record<Method, string> = {
  'closed-form': 'Closed form',
  'wavelength-loop': 'Loop over wavelengths',
  'line-sum': 'Line sum',
  'jacobi-anger': 'Jacobi–Anger series',
  taylor: 'Taylor series',
  baked: 'Baked modes',
}

const { degToRad, radToDeg } = MathUtils

/** All controls, in groups that can be folded. */
export class Panel {
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
    this.#group('Surface', true, [
      this.#choice('Pattern', FOILS, {
        get: () => {
          if (!(surface() instanceof Foil)) return undefined
          return demo.foilUrl in FOILS ? demo.foilUrl : ''
        },
        set: (url) => {
          if (url !== '') void demo.showFoil(url)
        },
      }),
      foilField(demo),
      this.#choice('Relief', FIELDS, {
        // The material's: one that is on its way is the one that was chosen.
        get: () => only(demo.subject.material.surface, HeightField)?.field as FieldName | undefined,
        set: (value) => void demo.showField(value),
      }),
      this.#slider({
        label: 'Period',
        unit: 'µm',
        ...{ min: 0.4, max: 6, step: 0.01 },
        ...property(grating, 'period'),
      }),
      this.#slider({
        label: 'Relief height',
        unit: 'µm',
        ...{ min: 0.01, max: 0.5, step: 0.005 },
        ...property(profiled, 'height'),
      }),
      this.#choice('Profile', PROFILES, property(profiled, 'profile')),
      this.#degrees('Orientation', -180, 180, 1, property(directed, 'orientation')),
      this.#choice('Metal', METALS, {
        get: () => (dielectric() === undefined ? demo.subject.material.metal : undefined),
        set: (value) => {
          adjust(demo.subject.material, { metal: value })
        },
      }),
      this.#slider({
        label: 'Refractive index',
        unit: '',
        ...{ min: 1.05, max: 2.5, step: 0.01 },
        get: () => dielectric()?.ior ?? undefined,
        set: property(dielectric, 'ior').set,
      }),
      this.#degrees('Roughness (σ of tilt)', 0, 5, 0.05, {
        get: () => demo.subject.material.roughness,
        set: (value) => {
          adjust(demo.subject.material, { roughness: value })
        },
      }),
      this.#slider({
        label: 'Clear coat',
        unit: '%',
        ...{ min: 0, max: 100, step: 1 },
        get: () => 100 * demo.subject.material.coat,
        set: (value) => (demo.subject.material.coat = value / 100),
      }),
      this.#degrees(
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
        'Environment',
        { ...ENVIRONMENTS, none: 'None' },
        {
          get: () => surroundings.chosen,
          set: (value) => void demo.showEnvironment(value),
        },
      ),
      this.#slider({
        label: 'Brightness',
        unit: '%',
        ...{ min: 0, max: 300, step: 5 },
        get: () => 100 * surroundings.brightness,
        set: (value) => (surroundings.brightness = value / 100),
      }),
      this.#degrees('Turn', -180, 180, 1, {
        get: () => surroundings.turn,
        set: (value) => (surroundings.turn = value),
      }),
      this.#slider({
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
        label: 'Intensity',
        unit: 'cd',
        ...{ min: 0, max: 20, step: 0.1 },
        get: () => flash.intensity,
        set: (value) => (flash.intensity = value),
      }),
      this.#degrees('Angular radius (σ)', 0.05, 5, 0.05, {
        get: () => flash.angularRadius,
        set: (value) => (flash.angularRadius = value),
      }),
      this.#degrees('Azimuth', -180, 180, 1, {
        get: () => flash.azimuth,
        set: (value) => (flash.azimuth = value),
      }),
      this.#degrees('Height', -85, 85, 1, {
        get: () => flash.height,
        set: (value) => (flash.height = value),
      }),
    ])
  }

  #addMethod(): void {
    const { demo } = this
    this.#group('Light and method', false, [
      this.#choice('Illuminant', ILLUMINANTS, {
        get: () => demo.subject.material.illuminant as keyof typeof ILLUMINANTS,
        set: (value) => {
          adjust(demo.subject.material, { illuminant: value })
        },
      }),
      this.#choice('Method', METHODS, {
        offered: () => bakedMethods(demo.subject.surface),
        get: () => demo.subject.material.method,
        set: (value) => (demo.subject.material.method = value),
      }),
      this.#slider({
        label: 'Coherence (σ of window)',
        unit: 'µm',
        ...{ min: 1, max: 60, step: 0.25 },
        get: () => demo.subject.material.coherence,
        set: (value) => {
          adjust(demo.subject.material, { coherence: value })
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
    return slider(options, this.demo.attempt)
  }

  #choice<T extends string>(
    label: string,
    options: Readonly<Record<T, string>>,
    value: Omit<ChoiceOptions<T>, 'label' | 'options'>,
  ): Control {
    return choice({ label, options, ...value }, this.demo.attempt)
  }

  /** A slider in degrees for a value in radians. */
  #degrees(
    label: string,
    min: number,
    max: number,
    step: number,
    { get, set }: { get: () => number | undefined; set: (value: number) => void },
  ): Control {
    return this.#slider({
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
