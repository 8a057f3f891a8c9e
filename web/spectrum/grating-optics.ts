import { arrayOf, constantOf, type LoadedMap } from '../maps/load'
import { tableTexture } from '../maps/upload'
import type { Optics, OpticsSettings } from '../surfaces/surface'
import { lobeTexture } from './lobe-texture'
import { maxOrder } from './max-order'
import { metalReflectance } from './metal-reflectance'
import { nodesTexture, spectralNodes } from './spectral-nodes'

/** The tables that a grating's optics read. */
export interface GratingTables {
  profile: LoadedMap
  lobes: LoadedMap
  metals: LoadedMap
}

export interface GratingOpticsSettings extends OpticsSettings {
  /** Height h0 of the relief, µm. */
  height: number
  /** Shortest and longest period on the surface, µm. */
  period: readonly [number, number]
}

/** Nodes of the direct sum for wide lobes: their bands are then 0.05 1/µm wide, as is the narrowest such lobe. */
const WIDE_LOBE_NODES = 28

/** The visible range in wavelength, µm. */
const VISIBLE = 0.4

/**
 * Share of a node's arc over which it is filtered: less than all of it, since a mip level blurs across the arc too.
 * Measured on the environments of docs/report.
 */
const ARC_FILTER = 0.7

/** Defines and uniforms of shaders/grating.glsl. */
export function gratingOptics(tables: GratingTables, settings: GratingOpticsSettings): Optics {
  const { profile, lobes, metals } = tables
  const [, widths, positions] = arrayOf(lobes, 'lobe').spec.axes
  const [orders, phases] = arrayOf(profile, 'efficiency').spec.axes
  const isLoop = settings.method === 'wavelength-loop'
  const isTaylor = settings.efficiencies === 'taylor'
  const lightNodes = isLoop
    ? spectralNodes(lobes, Math.round(VISIBLE / settings.wavelengthStep) + 1, 'uniform')
    : spectralNodes(lobes, WIDE_LOBE_NODES, 'weighted')
  const environmentNodes = spectralNodes(
    lobes,
    settings.environmentNodes,
    isLoop ? 'uniform' : 'weighted',
  )
  const reflectance = metalReflectance(metals, settings.metal)
  const defines: Record<string, string | number> = {
    MAX_ORDER: isTaylor ? 2 : maxOrder(profile, settings.period[1], settings.height),
    TABLE_ORDER: orders!.last,
    EFFICIENCY_PHASES: glslFloat(phases!.size),
    PHASE_MAX: glslFloat(phases!.last),
    LOBE_POSITIONS: glslFloat(positions!.size),
    LOBE_WIDTHS: glslFloat(widths!.size),
    LOBE_WIDTH_MIN: glslFloat(widths!.first),
    LOBE_WIDTH_MAX: glslFloat(widths!.last),
    LOBE_MARGIN: glslFloat(constantOf(lobes, 'margin')[0]!),
    WAVENUMBER_MIN: glslFloat(constantOf(lobes, 'wavenumber_min')[0]!),
    WAVENUMBER_MAX: glslFloat(constantOf(lobes, 'wavenumber_max')[0]!),
    LIGHT_NODES: lightNodes.length,
    // Standard deviation of a node's band, a box, in µm; times s² it is one in wavenumber.
    NODE_WIDTH: glslFloat(VISIBLE / lightNodes.length / Math.sqrt(12)),
    ENVIRONMENT_NODES: environmentNodes.length,
    // The papers' methods read the environment unfiltered.
    ARC_FILTER: glslFloat(isLoop ? 0 : ARC_FILTER),
  }
  if (isLoop) defines['WAVELENGTH_LOOP'] = ''
  if (isTaylor) defines['EFFICIENCY_TAYLOR'] = ''
  if (settings.energy === 'kirchhoff') defines['ENERGY_KIRCHHOFF'] = ''
  if (settings.energy === 'reciprocal') defines['ENERGY_RECIPROCAL'] = ''
  return {
    defines,
    uniforms: {
      uEfficiencyTable: { value: tableTexture(profile, 'efficiency') },
      uGratingHeight: { value: settings.height },
      uLobeTable: { value: lobeTexture(lobes, reflectance) },
      uWindowVariance: { value: 1 / (8 * Math.PI ** 2 * settings.coherence ** 2) },
      uRoughness: { value: settings.roughness },
      uLightNodes: { value: nodesTexture(lightNodes, reflectance) },
      uEnvironmentNodes: { value: nodesTexture(environmentNodes, reflectance) },
    },
  }
}

/** A number as a GLSL literal of type float. */
function glslFloat(value: number): string {
  const text = String(value)
  return /[.e]/.test(text) ? text : `${text}.0`
}
