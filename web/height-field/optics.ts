import type { DataTexture, IUniform } from 'three'
import type { LoadedMap } from '../maps/load.ts'
import { spectrumOptics } from '../spectrum/spectrum-optics.ts'
import { atOnce, bitByBit, type Steps } from '../steps.ts'
import type { Feature, LightOptics, Metal, Optics, OpticsSettings } from '../surfaces/surface.ts'
import { bakedPattern } from './baked-pattern.ts'
import type { Tiles } from './cut-window.ts'
import { environmentTexture, samplesCode } from './environment-texture.ts'
import { lineSpectrum } from './line-spectrum.ts'
import { lookups, W_STEPS } from './lookups.ts'

/** The maps that a height field's optics read. */
export interface HeightFieldMaps {
  relief: LoadedMap
  lobes: LoadedMap
  metals: LoadedMap
}

/** What the pattern under lights adds, whichever way it is computed. */
export interface Pattern {
  defines: Record<string, string | number>
  uniforms: Record<string, IUniform>
  features: readonly Feature[]
  underLights: (angularRadius: number) => LightOptics
}

/** Null: a perfect mirror. Relative to a flat surface of the same metal, its reflectance cancels. */
function metalOf({ energy, metal }: OpticsSettings, isDielectric: boolean): Metal | null {
  return energy === 'relative' || isDielectric ? null : metal
}

/**
 * Defines and uniforms of shaders/height-field.glsl.
 *
 * @param isDielectric - whether the reflectance is a dielectric's, in place of the settings' metal
 * @param tiles - how many patches cut the coherence window, if any do
 */
export function heightFieldOptics(
  { relief, lobes, metals }: HeightFieldMaps,
  settings: OpticsSettings,
  isDielectric: boolean,
  tiles: Tiles | null,
): Optics {
  const { method, energy, environmentNodes, roughness } = settings
  const isRelative = energy === 'relative'
  const metal = metalOf(settings, isDielectric)
  const samples = (): Steps<DataTexture> =>
    environmentTexture(relief, lobes, metals, metal, environmentNodes)
  const pattern =
    method === 'baked'
      ? bakedPattern(relief, settings, isDielectric, tiles)
      : lineSpectrum({ relief, lobes, metals }, settings, metal, tiles)
  const { defines, uniforms } = spectrumOptics(lobes, settings)
  return {
    defines: {
      ...defines,
      ...pattern.defines,
      ...(isRelative && { ENERGY_RELATIVE: '' }),
      ...(isDielectric && { DIELECTRIC: '' }),
      ENVIRONMENT_SAMPLES: lookups(environmentNodes),
      ENVIRONMENT_W_STEPS: W_STEPS,
      MIRROR_LOOKUPS: roughness > 0 ? 4 : 1,
    },
    uniforms: {
      ...uniforms,
      ...pattern.uniforms,
    },
    // Samples are merged over wavelengths: there are no others in between.
    blursEnvironment: false,
    environmentRefinement: null,
    environmentUniforms: () => ({ uEnvironmentSamples: { value: atOnce(samples()) } }),
    // Only a frame tells whether there is an environment, and is no time for such work.
    prepare: (isWanted) => {
      const steps = samples()
      if (samplesCode.code !== null && steps.next().done === true) return null
      const wanted = function* (): Steps<void> {
        while (isWanted() && steps.next().done !== true) yield
      }
      return samplesCode.load().then(() => bitByBit(wanted()))
    },
    features: [
      ...pattern.features,
      { feature: "the metal's colour", included: metal !== null, why: whyMetal(energy, metal) },
      {
        feature: 'roughness',
        included: roughness > 0,
        why: `the surface tilts by ${roughness} rad`,
      },
    ],
    environmentFeatures: [
      {
        feature: `at most ${lookups(environmentNodes)} lookups of the environment`,
        included: true,
        why: `of all lines at all wavelengths, alike in each frame; environmentNodes is ${environmentNodes}`,
      },
    ],
    underLights: pattern.underLights,
  }
}

function whyMetal(energy: OpticsSettings['energy'], metal: OpticsSettings['metal'] | null): string {
  if (energy === 'relative') return "energy is 'relative'"
  return metal === null ? 'the surface has an ior' : `metal is '${metal}'`
}
