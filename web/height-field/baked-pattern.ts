import { DataArrayTexture, DataTexture, FloatType, HalfFloatType, RGBAFormat, Vector2 } from 'three'
import { refuse } from '../errors.ts'
import { floatLiteral } from '../glsl/float-literal.ts'
import { arrayOf, constantOf, valuesOf, type LoadedMap } from '../maps/load.ts'
import { filtered, sharedTexture, unfiltered } from '../maps/shared-texture.ts'
import type { LightOptics, OpticsSettings } from '../surfaces/surface.ts'
import type { Tiles } from './cut-window.ts'
import type { Pattern } from './optics.ts'

/** Defines and uniforms of shaders/baked-pattern.glsl; refuses settings other than those that were baked in. */
export function bakedPattern(
  relief: LoadedMap,
  settings: OpticsSettings,
  isDielectric: boolean,
  tiles: Tiles | null,
): Pattern {
  const unfit = unlikeBaked(relief.sidecar.recipe, settings, isDielectric, tiles)
  if (unfit !== null)
    refuse(
      `${relief.url}.json`,
      unfit.field,
      unfit.value,
      `${JSON.stringify(unfit.baked)}, which was baked in, or another method`,
    )
  const constant = (name: string): number => constantOf(relief, name)[0]!
  const [groups, samples] = arrayOf(relief, 'weights').spec.shape
  return {
    defines: {
      BAKED: '',
      MODE_GROUPS: groups!,
      WEIGHT_SAMPLES: samples!,
      COHERENT_REACH: floatLiteral(arrayOf(relief, 'coherent').spec.axes[0]!.last),
    },
    uniforms: {
      uModes: { value: modesTexture(relief) },
      uModeWeights: { value: weightsTexture(relief) },
      uCoherent: { value: coherentTexture(relief) },
      uPatternReach: { value: new Vector2(constant('u_max'), constant('v_max')) },
      uPatternRadius: { value: constant('angular_radius') },
    },
    features: [
      {
        feature: `baked pattern of ${constant('modes')} modes`,
        included: true,
        why: `method is '${settings.method}'`,
      },
    ],
    underLights: (angularRadius) => lightSize(angularRadius, constant('angular_radius')),
  }
}

/** The first setting that is not as a recipe has it baked in; null where all are. */
export function unlikeBaked(
  recipe: Record<string, unknown>,
  settings: OpticsSettings,
  isDielectric: boolean,
  tiles: Tiles | null,
): { field: string; value: unknown; baked: unknown } | null {
  const asked = {
    roughness: settings.roughness,
    coherence: settings.coherence,
    illuminant: settings.illuminant,
    observer: settings.observer,
    metal: isDielectric ? null : settings.metal,
    energy: settings.energy,
    tiles,
  }
  const bakedIn: Record<string, unknown> = { ...recipe, observer: '1931-2', energy: 'kirchhoff' }
  for (const [field, value] of Object.entries(asked)) {
    const baked = bakedIn[field]
    if (JSON.stringify(value) !== JSON.stringify(baked)) return { field, value, baked }
  }
  return null
}

function lightSize(angularRadius: number, baked: number): LightOptics {
  const included = angularRadius === baked
  const why = included
    ? 'the map was baked for it'
    : `the map was baked for lights of ${baked} rad, and shows all as such`
  return { defines: {}, features: [{ feature: 'size of the lights', included, why }] }
}

/** Spline coefficients over (u, v), three layers a group of four modes. */
function modesTexture(relief: LoadedMap): DataArrayTexture {
  return sharedTexture(relief, 'modes', () => {
    const { spec, data } = arrayOf(relief, 'modes')
    const [layers, height, width] = spec.shape
    const texture = new DataArrayTexture(data, width, height, layers)
    texture.format = RGBAFormat
    texture.type = HalfFloatType
    return filtered(texture)
  })
}

/** Order 0 over w and the distance from its middle. */
function coherentTexture(relief: LoadedMap): DataTexture {
  return sharedTexture(relief, 'coherent', () => {
    const { spec, data } = arrayOf(relief, 'coherent')
    const [height, width] = spec.shape
    return filtered(new DataTexture(data, width, height, RGBAFormat, HalfFloatType))
  })
}

/** ψ over w, four modes a texel, a row a group. */
function weightsTexture(relief: LoadedMap): DataTexture {
  return sharedTexture(relief, 'weights', () => {
    const array = arrayOf(relief, 'weights')
    const [groups, samples] = array.spec.shape
    return unfiltered(new DataTexture(valuesOf(array), samples, groups, RGBAFormat, FloatType))
  })
}
