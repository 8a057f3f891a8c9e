import type { Texture } from 'three'
import type { RoughReasons } from '../environment/rough-environment.ts'
import type { DiffractionError } from '../errors.ts'
import type { Feature } from '../surfaces/surface.ts'

interface MaterialState {
  defines: Record<string, unknown>
  /** What the surface's optics say of themselves. */
  opticsFeatures: readonly Feature[]
  /** What they say of what an environment asks for. */
  environmentFeatures: readonly Feature[]
  /** Channels of the environment that held what light cannot be. */
  environmentRepaired: number
  /** Why a flat mesh's table, or the environment blurred for the roughness, are in or out. */
  roughWhy: RoughReasons
  diffraction: boolean
  opticsState: 'loading' | 'ready' | 'failed'
  opticsError: DiffractionError | null
  isPartial: boolean
  surfaceName: string
  gamut: 'map' | 'signed'
  textures: Record<string, Texture | null>
  /** Visible lights that diffract. */
  lights: number
}

/** The report behind `material.explain()`. Lights and environment are as in the last frame drawn. */
export function describeFeatures(state: MaterialState): Feature[] {
  const isIn = (name: string): boolean => name in state.defines
  const choose = (feature: string, included: boolean, yes: string, no: string): Feature => ({
    feature,
    included,
    why: included ? yes : no,
  })
  return [
    choose(
      'diffraction',
      isIn('DIFFRACTION'),
      `the tables of ${state.surfaceName} are loaded`,
      whyNot(state),
    ),
    choose(
      'matt base',
      state.isPartial,
      `the strength of ${state.surfaceName} is below 1 somewhere`,
      `the strength of ${state.surfaceName} is 1 everywhere`,
    ),
    choose('lacquer', isIn('COAT'), 'coat is above 0', 'coat is 0'),
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
    choose(
      'table of the environment for a flat surface',
      isIn('PLANAR_TEXELS'),
      state.roughWhy.planar,
      state.roughWhy.planar,
    ),
    choose(
      'environment blurred for the roughness',
      isIn('BLURRED_LAYERS'),
      state.roughWhy.blur,
      state.roughWhy.blur,
    ),
    choose('gamut mapping', state.gamut === 'map', "gamut is 'map'", "gamut is 'signed'"),
    ...Object.entries(state.textures).map(([name, texture]) =>
      choose(name, texture !== null, 'a texture is set', 'no texture is set'),
    ),
    ...state.opticsFeatures,
    ...(isIn('ENVIRONMENT_EQUIRECT') || isIn('ENVIRONMENT_CUBE')
      ? state.environmentFeatures
      : state.environmentFeatures.map(({ feature }) =>
          choose(feature, false, '', 'there is no environment'),
        )),
  ]
}

function whyNot(state: MaterialState): string {
  if (!state.diffraction) return 'diffraction is false'
  if (state.opticsState === 'failed')
    return `the tables failed: ${state.opticsError?.message ?? ''}`
  return 'the tables are loading'
}
