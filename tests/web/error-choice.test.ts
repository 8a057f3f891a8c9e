import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { DiffractionMaterial } from '../../web/materials/DiffractionMaterial'
import {
  choiceForError,
  MEASURED_ERRORS,
  type MeasuredErrors,
} from '../../web/materials/error-choice'
import {
  CHOSEN_SETTINGS,
  DEFAULT_SETTINGS,
  SETTING_CHECKS,
  type ChosenSettings,
  type DiffractionMaterialOptions,
} from '../../web/materials/options'
import { Grating } from '../../web/surfaces/grating'
import { HeightField } from '../../web/surfaces/height-field'
import { fakeLobes, fakeMetals, fakeProfile, filesOf, serveFiles } from './fake-maps'
import { refuses } from './refuses'

/** A report in which what costs more errs less, but for one setting that nothing speaks for. */
const MEASURED: MeasuredErrors = {
  grating: {
    lights: {
      scenes: 7,
      settings: [
        { options: { method: 'closed-form' }, rel_rmse: 0.01, time_ratio: 2 },
        loop({ wavelengthStep: 0.05 }, 0.1, 10),
        loop({ wavelengthStep: 0.01 }, 0.004, 50),
        loop({ wavelengthStep: 0.001 }, 0.0005, 500),
      ],
    },
    environment: {
      scenes: 3,
      settings: [
        { options: { method: 'closed-form', environmentNodes: 6 }, rel_rmse: 0.03, time_ratio: 5 },
        // At the material's default.
        { options: { method: 'closed-form' }, rel_rmse: 0.02, time_ratio: 9 },
        {
          options: { method: 'closed-form', environmentNodes: 48 },
          rel_rmse: 0.004,
          time_ratio: 30,
        },
        loop({ environmentNodes: 100 }, 0.002, 70),
      ],
    },
  },
}

function loop(
  knob: Record<string, number>,
  rel_rmse: number,
  time_ratio: number,
): { options: Record<string, string | number>; rel_rmse: number; time_ratio: number } {
  return {
    options: { method: 'wavelength-loop', efficiencies: 'table', ...knob },
    rel_rmse,
    time_ratio,
  }
}

const grating = new Grating({ period: 1.6, height: 0.1 })

function choose(
  maxError: number,
  given: Partial<ChosenSettings> = {},
  measured = MEASURED,
): ReturnType<typeof choiceForError> {
  const settings = { ...DEFAULT_SETTINGS, ...given }
  return choiceForError(grating, settings, new Set(Object.keys(given)), maxError, measured)
}

describe('the choice for an error', () => {
  it.each([
    [1, { method: 'closed-form', environmentNodes: 6 }, [true, true]],
    [0.03, { method: 'closed-form', environmentNodes: 6 }, [true, true]],
    [0.02, { method: 'closed-form', environmentNodes: 12 }, [true, true]],
    [0.01, { method: 'closed-form', environmentNodes: 48 }, [true, true]],
    // The closed form no longer does under lights.
    [
      0.005,
      { method: 'wavelength-loop', wavelengthStep: 0.01, environmentNodes: 100 },
      [true, true],
    ],
    // Nothing does around a surface: the least error of all.
    [
      0.001,
      { method: 'wavelength-loop', wavelengthStep: 0.001, environmentNodes: 100 },
      [true, false],
    ],
    [
      1e-6,
      { method: 'wavelength-loop', wavelengthStep: 0.001, environmentNodes: 100 },
      [false, false],
    ],
  ])('of %f is the cheapest that was measured to suffice', (maxError, settings, enough) => {
    const choice = choose(maxError)
    expect(choice.settings).toMatchObject({ efficiencies: 'table', ...settings })
    expect(choice.features.map(({ included }) => included)).toEqual(enough)
  })

  it('says what it rests on, and where it is not enough', () => {
    const [lights, environment] = choose(0.001).features
    expect(lights).toEqual({
      feature: 'error under lights of at most 0.001',
      included: true,
      why: "method 'wavelength-loop', wavelengthStep 0.001: was at most 0.0005 off in the report's 7 scenes of a grating under lights",
    })
    expect(environment!.why).toContain('environmentNodes 100: was at most 0.002 off')
    expect(environment!.why).toContain('the least that can be chosen')
  })

  it('leaves what was given', () => {
    expect(choose(0.001, { method: 'closed-form' }).settings).toMatchObject({
      method: 'closed-form',
      environmentNodes: 48,
    })
    // The first that does among those with that many nodes.
    expect(choose(0.005, { environmentNodes: 48 }).settings).not.toHaveProperty('environmentNodes')
    expect(choose(0.005, { environmentNodes: 12 }).settings.method).toBe('closed-form')
    const unmeasured = choose(0.01, { environmentNodes: 33 })
    expect(unmeasured.settings).toMatchObject({ method: 'closed-form' })
    expect(unmeasured.features[1]!.why).toContain('not measured the settings that were given')
  })

  it('says that a surface was not measured, and chooses nothing', () => {
    const { settings, features } = choose(0.01, {}, {})
    expect(settings).toEqual({})
    expect(features.map(({ why }) => why)).toEqual([
      'the report has measured no grating under lights',
      'the report has measured no grating in environments',
    ])
  })

  it('keeps to methods that read the same maps', () => {
    const setting = (method: string, rel_rmse: number, time_ratio: number) => ({
      options: { method },
      rel_rmse,
      time_ratio,
    })
    const lights = {
      scenes: 2,
      settings: [
        setting('baked', 0.001, 1),
        setting('line-sum', 0.01, 10),
        setting('jacobi-anger', 0.002, 100),
        setting('taylor', 0.0001, 200),
      ],
    }
    const field = new HeightField({ field: 'x' })
    const base = { ...DEFAULT_SETTINGS, roughness: 0.01 }
    const methodFor = (
      maxError: number,
      given: Partial<ChosenSettings> = {},
      around = 0.0001,
    ): unknown =>
      choiceForError(
        field,
        { ...base, method: 'line-sum', ...given },
        new Set(Object.keys(given)),
        maxError,
        {
          'rough height field': {
            lights,
            environment: {
              scenes: 1,
              settings: [{ options: {}, rel_rmse: around, time_ratio: 5 }],
            },
          },
        },
      ).settings.method
    expect(methodFor(0.01)).toBe('line-sum')
    expect(methodFor(0.005)).toBe('jacobi-anger')
    expect(methodFor(1e-5)).toBe('jacobi-anger')
    // As far off in environments, whichever it is: the faster one.
    expect(methodFor(0.01, {}, 0.05)).toBe('line-sum')
    expect(methodFor(0.005, { method: 'baked' })).toBe('baked')
  })
})

describe('the table of measured errors', () => {
  it('names settings that a material takes', () => {
    const measured = Object.values(MEASURED_ERRORS).flatMap((parts) => Object.values(parts))
    const settings = measured.flatMap(({ settings }) => settings)
    expect(settings.length).toBeGreaterThan(10)
    for (const { options, rel_rmse, time_ratio } of settings) {
      for (const [name, value] of Object.entries(options)) {
        expect(CHOSEN_SETTINGS).toContain(name)
        expect(SETTING_CHECKS[name as keyof ChosenSettings]('', value)).toBe(value)
      }
      expect(rel_rmse).toBeGreaterThan(0)
      expect(time_ratio).toBeGreaterThan(0)
    }
  })

  it('has every class of surface', () => {
    const fields = [
      new HeightField({ field: 'x' }).measuredAs(DEFAULT_SETTINGS),
      new HeightField({ field: 'x' }).measuredAs({ ...DEFAULT_SETTINGS, roughness: 0.01 }),
      new HeightField({ field: 'x', tiles: 3 }).measuredAs(DEFAULT_SETTINGS),
    ]
    for (const name of ['grating', 'foil', ...fields])
      expect(MEASURED_ERRORS).toHaveProperty([name])
  })
})

describe('a material', () => {
  let mapsPath = ''
  let folder = 0

  beforeEach(() => {
    mapsPath = `errors${++folder}/`
    const maps = {
      [`${mapsPath}profile-sinusoidal`]: fakeProfile(),
      [`${mapsPath}lobes-1931-2-D65`]: fakeLobes(),
      [`${mapsPath}metals`]: fakeMetals(),
    }
    serveFiles(filesOf(maps))
  })

  afterEach(() => {
    vi.unstubAllGlobals()
  })

  const made = (options: Partial<DiffractionMaterialOptions>): DiffractionMaterial =>
    new DiffractionMaterial({ surface: grating, mapsPath, ...options })
  const said = (material: DiffractionMaterial): string[] =>
    material.explain().flatMap(({ feature, why }) => (feature.startsWith('error') ? [why] : []))

  it('is as given without an error to keep', async () => {
    const material = made({})
    await material.ready
    expect(material.maxError).toBeNull()
    expect(material).toMatchObject({ method: 'closed-form', environmentNodes: 12 })
    expect(said(material)).toEqual([])
  })

  it('chooses what the table says, again when the error changes, and nothing without one', async () => {
    const material = made({ maxError: 0.5 })
    await material.ready
    for (const maxError of [0.5, 0.02, 1e-9]) {
      material.maxError = maxError
      const { settings, features } = choiceForError(grating, DEFAULT_SETTINGS, new Set(), maxError)
      expect(material).toMatchObject(settings)
      expect(said(material)).toEqual(features.map(({ why }) => why))
    }
    material.maxError = null
    expect(material).toMatchObject({ method: 'closed-form', environmentNodes: 12 })
    expect(said(material)).toEqual([])
  })

  it('keeps what it was given, whenever', async () => {
    const material = made({ maxError: 1e-9, environmentNodes: 5, method: 'wavelength-loop' })
    await material.ready
    expect(material).toMatchObject({ method: 'wavelength-loop', environmentNodes: 5 })
    material.method = 'closed-form'
    material.maxError = 0.5
    expect(material).toMatchObject({ method: 'closed-form', environmentNodes: 5 })
  })

  it('hands on to its clone what it was given, and the error', async () => {
    const material = made({ maxError: 1e-9, environmentNodes: 5 })
    await material.ready
    const clone = material.clone()
    await clone.ready
    expect(clone).toMatchObject({ maxError: 1e-9, environmentNodes: 5, method: material.method })
    clone.maxError = null
    expect(clone).toMatchObject({ environmentNodes: 5, method: 'closed-form' })
  })

  it('refuses an error that means nothing', async () => {
    for (const value of [0, -0.1, NaN, Infinity, '0.01'] as number[]) {
      refuses(() => made({ maxError: value }), 'DiffractionMaterial', 'maxError')
    }
    const material = made({ maxError: 0.01 })
    await material.ready
    refuses(() => (material.maxError = 0), 'DiffractionMaterial', 'maxError')
    expect(material.maxError).toBe(0.01)
  })
})
