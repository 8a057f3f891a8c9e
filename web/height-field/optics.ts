import { DataTexture, FloatType, RGBAFormat, type IUniform } from 'three'
import { floatLiteral } from '../glsl/float-literal'
import { arrayOf, valuesOf, type LoadedMap } from '../maps/load'
import { sharedTexture, unfiltered } from '../maps/shared-texture'
import { stepTexture } from '../maps/step-texture'
import { SpectralTextures } from '../spectrum/spectral-textures'
import { ARC_FILTER, spectrumOptics } from '../spectrum/spectrum-optics'
import type { Feature, LightOptics, Optics, OpticsSettings } from '../surfaces/surface'
import { bakedPattern } from './baked-pattern'
import { lineSpectrum } from './line-spectrum'

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
  /** How many nodes stand for the spectrum of a light, and how they share it out. */
  nodes: { count: number; placement: 'uniform' | 'weighted' }
}

/**
 * Defines and uniforms of shaders/height-field.glsl.
 *
 * @param isDielectric - whether the reflectance is a dielectric's, in place of the settings' metal
 */
export function heightFieldOptics(
  { relief, lobes, metals }: HeightFieldMaps,
  settings: OpticsSettings,
  isDielectric: boolean,
): Optics {
  const { method, energy, environmentNodes, roughness } = settings
  const isRelative = energy === 'relative'
  const pattern =
    method === 'baked'
      ? bakedPattern(relief, lobes, settings, isDielectric)
      : lineSpectrum(relief, lobes, settings)
  // Relative to a flat surface of the same metal, its reflectance cancels.
  const metal = isRelative || isDielectric ? null : settings.metal
  const spectra = new SpectralTextures(lobes, metals, metal)
  const { defines, uniforms } = spectrumOptics(lobes, settings)
  const [cells, phases] = arrayOf(relief, 'powers').spec.axes
  return {
    defines: {
      ...defines,
      ...pattern.defines,
      ...(isRelative && { ENERGY_RELATIVE: '' }),
      ARC_FILTER: floatLiteral(ARC_FILTER),
      CELLS: cells!.size,
      CELL_PHASES: phases!.size,
      CELL_PHASE_MAX: floatLiteral(phases!.last),
      ENVIRONMENT_NODES: environmentNodes,
      LIGHT_NODES: pattern.nodes.count,
    },
    uniforms: {
      ...uniforms,
      ...pattern.uniforms,
      uCellPowers: { value: stepTexture(relief, 'powers') },
      uCells: { value: cellsTexture(relief) },
      uEnvironmentNodes: { value: spectra.nodes(environmentNodes, 'weighted') },
      uLightNodes: { value: spectra.nodes(pattern.nodes.count, pattern.nodes.placement) },
      uLobeTable: { value: spectra.lobe() },
    },
    features: [
      ...pattern.features,
      { feature: "the metal's colour", included: metal !== null, why: whyMetal(energy, metal) },
      {
        feature: 'roughness',
        included: roughness > 0,
        why: `the surface tilts by ${roughness} rad`,
      },
      {
        feature: `${cells!.size} cells of the spectrum`,
        included: true,
        why: `its lines are looked up together, at ${environmentNodes} wavelengths, wherever there is an environment`,
      },
    ],
    underLights: pattern.underLights,
  }
}

function whyMetal(energy: OpticsSettings['energy'], metal: OpticsSettings['metal'] | null): string {
  if (energy === 'relative') return "energy is 'relative'"
  return metal === null ? 'the surface has an ior' : `metal is '${metal}'`
}

/** Centroids and deviations of the cells, a column each. */
function cellsTexture(relief: LoadedMap): DataTexture {
  return sharedTexture(relief, 'places', () => {
    const array = arrayOf(relief, 'places')
    const [count] = array.spec.shape
    return unfiltered(new DataTexture(valuesOf(array), count, 1, RGBAFormat, FloatType))
  })
}
