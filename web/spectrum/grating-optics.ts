import { floatLiteral } from '../glsl/float-literal.ts'
import { arrayOf, constantOf, type LoadedMap } from '../maps/load.ts'
import { stepTexture } from '../maps/step-texture.ts'
import type {
  EnvironmentRefinement,
  Feature,
  LightOptics,
  Optics,
  OpticsSettings,
} from '../surfaces/surface.ts'
import { maxOrder, propagatingOrder } from './max-order.ts'
import { SpectralTextures } from './spectral-textures.ts'
import { ARC_FILTER, spectrumOptics, wavelengthsOfLoop, windowVariance } from './spectrum-optics.ts'

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
  /** How far the frequencies of gratings that are shown as one are off its own at most, 1/µm. */
  frequencyReach: number
}

/** Defines and uniforms of shaders/grating.glsl. */
export function gratingOptics(tables: GratingTables, settings: GratingOpticsSettings): Optics {
  const { profile, lobes, metals } = tables
  const [orders, phases] = arrayOf(profile, 'efficiency').spec.axes
  const isLoop = settings.method === 'wavelength-loop'
  const isTaylor = settings.efficiencies === 'taylor'
  const lightNodes = isLoop
    ? wavelengthsOfLoop(settings.wavelengthStep)
    : constantOf(lobes, 'wide_lobe_nodes')[0]!
  const placement = isLoop ? 'uniform' : 'weighted'
  const spectra = new SpectralTextures(lobes, metals, settings.metal)
  const isSymmetric = constantOf(profile, 'symmetric')[0] === 1
  const shown = isTaylor ? 2 : maxOrder(profile, settings.period[1], settings.height)
  const spectrum = spectrumOptics(lobes, settings)
  const defines: Record<string, string | number> = {
    ...spectrum.defines,
    MAX_ORDER: shown,
    TABLE_ORDER: orders!.last,
    EFFICIENCY_PHASES: phases!.size,
    PHASE_MAX: floatLiteral(phases!.last),
    LIGHT_NODES: lightNodes,
    ENVIRONMENT_NODES: settings.environmentNodes,
    ARC_FILTER: floatLiteral(ARC_FILTER),
  }
  if (isLoop) defines['WAVELENGTH_LOOP'] = ''
  if (isSymmetric) defines['PROFILE_SYMMETRIC'] = ''
  if (isTaylor) defines['EFFICIENCY_TAYLOR'] = ''
  if (settings.energy === 'kirchhoff') defines['ENERGY_KIRCHHOFF'] = ''
  if (settings.energy === 'reciprocal') defines['ENERGY_RECIPROCAL'] = ''
  return {
    defines,
    underLights: (angularRadius) => wideLobes(!isLoop && canBeWide(lobes, settings, angularRadius)),
    features: describeOptics(settings, shown, isSymmetric),
    environmentFeatures: [describeNodes(settings)],
    uniforms: {
      ...spectrum.uniforms,
      uEfficiencyTable: {
        value: stepTexture(profile, 'efficiency', isSymmetric ? orders!.last : 0),
      },
      uGratingHeight: { value: settings.height },
      uLobeTable: { value: spectra.lobe() },
      uLightNodes: { value: spectra.nodes(lightNodes, placement) },
    },
    environmentUniforms: () => ({
      uEnvironmentNodes: {
        value: isLoop
          ? spectra.nodes(settings.environmentNodes, placement)
          : spectra.arcNodes(settings.environmentNodes),
      },
      uEnvironmentStart: { value: 0 },
    }),
    blursEnvironment: settings.roughness > 0 && !isLoop,
    environmentRefinement: isLoop ? null : refinement(spectra, settings.environmentNodes),
  }
}

/** Of 8 shares the mean of 12 nodes has the error at which more gain nothing, since each has to be white for itself. */
const MOST_SHARES = 8

/** Each frame reads its share of many times as many nodes, which cannot lie closer than the spectra's own nanometres. */
function refinement(spectra: SpectralTextures, nodes: number): EnvironmentRefinement {
  const closest = 2 ** Math.floor(Math.log2(wavelengthsOfLoop(0.001) / nodes))
  const most = Math.min(closest, MOST_SHARES)
  return {
    uniforms: (count) => ({
      uEnvironmentNodes: { value: spectra.refinedArcNodes(nodes, Math.min(count, most)) },
    }),
    // Before them are the nodes of a frame that stands alone.
    start: ({ index, count }) => (1 + (index % Math.min(count, most))) * nodes,
  }
}

function wideLobes(included: boolean): LightOptics {
  const why = included
    ? 'roughness, a light or a short coherence blurs neighbouring orders over one another near the highlight'
    : 'only order 0 is seen where lobes are wide'
  return {
    defines: { WIDE_LOBES: included },
    features: [{ feature: 'wide lobes of all orders', included, why }],
  }
}

/**
 * Whether an order other than 0 is in reach of a pixel whose lobes are wide, as shaders/grating.glsl decides both: the
 * lobes' deviation in spatial frequency is more than the table's largest width times ρ, and s u comes within the
 * exponent's cut of 1/a.
 */
function canBeWide(
  lobes: LoadedMap,
  { coherence, roughness, period, frequencyReach }: GratingOpticsSettings,
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
  // A lobe of order m is wider by m times that at most.
  return 1 / period[1] < (spread + frequencyReach) * (largestWavenumber / largestWidth + cut)
}

/** What `explain()` says of the optics. */
function describeOptics(
  settings: GratingOpticsSettings,
  shown: number,
  isSymmetric: boolean,
): Feature[] {
  const { period, height, method, wavelengthStep, energy, roughness } = settings
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
      feature: 'efficiencies of negative orders',
      included: !isSymmetric,
      why: isSymmetric
        ? 'the profile is symmetric: order −m takes as much as order m'
        : 'the profile is not symmetric',
    },
  ]
}

function describeNodes({ environmentNodes, method }: GratingOpticsSettings): Feature {
  return {
    feature: 'nodes along the environment',
    included: true,
    why: `${environmentNodes} wavelengths stand for the spectrum, ${method === 'wavelength-loop' ? 'the same' : 'others'} in each frame of a refinement`,
  }
}
