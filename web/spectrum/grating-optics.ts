import { arrayOf, constantOf, type LoadedMap } from '../maps/load'
import type { Feature, Optics, OpticsSettings } from '../surfaces/surface'
import { efficiencyTexture } from './efficiency-texture'
import { maxOrder, propagatingOrder } from './max-order'
import { SpectralTextures } from './spectral-textures'

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

/** The visible range in wavelength, µm. */
const VISIBLE = 0.4

/**
 * Share of a node's arc over which the environment is filtered. A mip level blurs across the arc as much as along it, so
 * less than the whole arc is best: of 0, 0.35, 0.7, 1 and 1.4 this had the least error with 8 to 21 nodes under the
 * studio, venice, night and warehouse environments of @pmndrs/assets.
 */
const ARC_FILTER = 0.35

/** Defines and uniforms of shaders/grating.glsl. */
export function gratingOptics(tables: GratingTables, settings: GratingOpticsSettings): Optics {
  const { profile, lobes, metals } = tables
  const [, widths, positions] = arrayOf(lobes, 'lobe').spec.axes
  const [orders, phases] = arrayOf(profile, 'efficiency').spec.axes
  const isLoop = settings.method === 'wavelength-loop'
  const isTaylor = settings.efficiencies === 'taylor'
  const lightNodes = isLoop
    ? Math.round(VISIBLE / settings.wavelengthStep) + 1
    : constantOf(lobes, 'wide_lobe_nodes')[0]!
  const placement = isLoop ? 'uniform' : 'weighted'
  const spectra = new SpectralTextures(lobes, metals, settings.metal)
  const shown = isTaylor ? 2 : maxOrder(profile, settings.period[1], settings.height)
  const defines: Record<string, string | number> = {
    MAX_ORDER: shown,
    TABLE_ORDER: orders!.last,
    EFFICIENCY_PHASES: phases!.size,
    PHASE_MAX: glslFloat(phases!.last),
    LOBE_POSITIONS: glslFloat(positions!.size),
    LOBE_WIDTHS: glslFloat(widths!.size),
    LOBE_WIDTH_MIN: glslFloat(widths!.first),
    LOBE_WIDTH_MAX: glslFloat(widths!.last),
    EXPONENT_CUT: glslFloat(constantOf(lobes, 'exponent_cut')[0]!),
    LOBE_MARGIN: glslFloat(constantOf(lobes, 'margin')[0]!),
    WAVENUMBER_MIN: glslFloat(constantOf(lobes, 'wavenumber_min')[0]!),
    WAVENUMBER_MAX: glslFloat(constantOf(lobes, 'wavenumber_max')[0]!),
    LIGHT_NODES: lightNodes,
    ENVIRONMENT_NODES: settings.environmentNodes,
    // The papers' methods read the environment unfiltered.
    ARC_FILTER: glslFloat(isLoop ? 0 : ARC_FILTER),
  }
  if (isLoop) defines['WAVELENGTH_LOOP'] = ''
  if (isTaylor) defines['EFFICIENCY_TAYLOR'] = ''
  if (settings.energy === 'kirchhoff') defines['ENERGY_KIRCHHOFF'] = ''
  if (settings.energy === 'reciprocal') defines['ENERGY_RECIPROCAL'] = ''
  return {
    defines,
    needsWideLobes: (angularRadius) => !isLoop && canBeWide(lobes, settings, angularRadius),
    features: describeOptics(settings, shown),
    uniforms: {
      uEfficiencyTable: { value: efficiencyTexture(profile) },
      uGratingHeight: { value: settings.height },
      uLobeTable: { value: spectra.lobe() },
      uWindowVariance: { value: windowVariance(settings.coherence) },
      uRoughness: { value: settings.roughness },
      uLightNodes: { value: spectra.nodes(lightNodes, placement) },
      uEnvironmentNodes: { value: spectra.nodes(settings.environmentNodes, placement) },
    },
  }
}

/**
 * Whether an order other than 0 is in reach of a pixel whose lobes are wide, as shaders/grating.glsl decides both: the
 * lobes' deviation in spatial frequency is more than the table's largest width times ρ, and s u comes within the
 * exponent's cut of 1/a.
 */
function canBeWide(
  lobes: LoadedMap,
  { coherence, roughness, period }: GratingOpticsSettings,
  angularRadius: number,
): boolean {
  const largestWavenumber = constantOf(lobes, 'wavenumber_max')[0]!
  const largestWidth = arrayOf(lobes, 'lobe').spec.axes[1]!.last
  const cut = Math.sqrt(2 * constantOf(lobes, 'exponent_cut')[0]!)
  // w is at most 2.
  const spread = Math.sqrt(
    windowVariance(coherence) +
      largestWavenumber ** 2 * ((2 * roughness) ** 2 + angularRadius ** 2),
  )
  return 1 / period[1] < spread * (largestWavenumber / largestWidth + cut)
}

/** Variance of the coherence window's lobe in spatial frequency, 1/µm². coherence: σ, µm. */
function windowVariance(coherence: number): number {
  return 1 / (8 * Math.PI ** 2 * coherence ** 2)
}

/** What `explain()` says of the optics. */
function describeOptics(settings: GratingOpticsSettings, shown: number): Feature[] {
  const { period, height, method, wavelengthStep, energy, roughness, environmentNodes } = settings
  const propagating = propagatingOrder(period[1])
  const isLoop = method === 'wavelength-loop'
  return [
    {
      feature: `orders up to ±${shown}`,
      included: true,
      why: `with ${height} µm of height they take more than 1/10000 of the light`,
    },
    {
      feature: `orders beyond ±${shown}`,
      included: false,
      why:
        propagating > shown
          ? `±${propagating} could propagate, but they take less than that at any wavelength`
          : `a period of ${period[1]} µm lets none propagate`,
    },
    {
      feature: 'closed form over wavelength',
      included: !isLoop,
      why: `method is '${method}'`,
    },
    {
      feature: 'wavelength loop',
      included: isLoop,
      why: isLoop ? `in steps of ${wavelengthStep * 1000} nm` : `method is '${method}'`,
    },
    {
      feature: 'sum over propagating orders',
      included: energy !== 'kirchhoff',
      why: `energy is '${energy}'`,
    },
    {
      feature: 'roughness',
      included: roughness > 0,
      why: `the surface tilts by ${roughness} rad`,
    },
    {
      feature: 'nodes along the environment',
      included: true,
      why: `${environmentNodes} wavelengths stand for the spectrum wherever there is an environment`,
    },
  ]
}

/** A number as a GLSL literal of type float. */
function glslFloat(value: number): string {
  const text = String(value)
  return /[.e]/.test(text) ? text : `${text}.0`
}
