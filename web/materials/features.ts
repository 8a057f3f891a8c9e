import type { RoughReasons } from '../environment/rough-environment.ts'
import type { Feature } from '../surfaces/surface.ts'
import type { OpticsLoader } from './optics-loader.ts'

interface SceneState {
  defines: Record<string, unknown>
  /** What the surface's optics say of themselves. */
  opticsFeatures: readonly Feature[]
  /** What they say of what an environment asks for. */
  environmentFeatures: readonly Feature[]
  /** Channels of the environment that held what light cannot be. */
  environmentRepaired: number
  /** Why a flat mesh's table, or the environment blurred for the roughness, are in or out. */
  roughWhy: RoughReasons
  /** Whether diffraction was asked for. */
  isOn: boolean
  state: OpticsLoader['state']
  error: Error | null
  surfaceName: string
  /** Visible lights that diffract. */
  lights: number
}

/** A thing that is in or out for one reason or another. */
export function choose(feature: string, included: boolean, yes: string, no: string): Feature {
  return { feature, included, why: included ? yes : no }
}

/** What surface, lights and environment have compiled in. Lights and environment are as in the last frame drawn. */
export function describeScene(state: SceneState): Feature[] {
  const isIn = (name: string): boolean => name in state.defines
  return [
    choose(
      'diffraction',
      isIn('DIFFRACTION'),
      `the tables of ${state.surfaceName} are loaded`,
      whyNot(state),
    ),
    choose(
      'lights',
      state.lights > 0,
      `${state.lights} that diffract are visible`,
      'none that diffracts is visible',
    ),
    choose(
      'tinted light',
      isIn('TINTED'),
      "a visible light's colour is not grey, or it has a map",
      'all visible lights are white or grey',
    ),
    choose(
      'equirectangular environment',
      isIn('ENVIRONMENT_EQUIRECT'),
      'the environment is an equirectangular texture',
      'there is none of that kind',
    ),
    choose(
      'cube environment',
      isIn('ENVIRONMENT_CUBE'),
      'the environment is a cube texture',
      'there is none of that kind',
    ),
    choose(
      'repair of the environment',
      state.environmentRepaired > 0,
      `${state.environmentRepaired} channels were negative, infinite or no number`,
      'all its texels are light',
    ),
    {
      feature: 'table of the environment for a flat surface',
      included: isIn('PLANAR_TEXELS'),
      why: state.roughWhy.planar,
    },
    {
      feature: 'environment blurred for the roughness',
      included: isIn('BLURRED_LAYERS'),
      why: state.roughWhy.blur,
    },
    ...state.opticsFeatures,
    ...(isIn('ENVIRONMENT_EQUIRECT') || isIn('ENVIRONMENT_CUBE')
      ? state.environmentFeatures
      : state.environmentFeatures.map(({ feature }) =>
          choose(feature, false, '', 'there is no environment'),
        )),
  ]
}

function whyNot(state: SceneState): string {
  if (!state.isOn) return 'diffraction is false'
  if (state.state === 'failed') return `the tables failed: ${state.error?.message ?? ''}`
  return 'the tables are loading'
}
