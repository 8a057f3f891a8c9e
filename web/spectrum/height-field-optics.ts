import { Vector2 } from 'three'
import { floatLiteral } from '../glsl/float-literal'
import { parameterFromTexel } from '../maps/axes'
import { arrayOf, constantOf, valuesOf, type LoadedMap } from '../maps/load'
import type { Feature, LightOptics, Optics, OpticsSettings } from '../surfaces/surface'
import { SpectralTextures } from './spectral-textures'
import { spectrumOptics, wavelengthsOfLoop } from './spectrum-optics'
import { termTextures } from './term-textures'

/** The maps that a height field's optics read. */
export interface HeightFieldMaps {
  terms: LoadedMap
  lobes: LoadedMap
  metals: LoadedMap
}

/**
 * Defines and uniforms of shaders/height-field.glsl.
 *
 * @param isDielectric - whether the reflectance is a dielectric's, in place of the settings' metal
 */
export function heightFieldOptics(
  { terms, lobes, metals }: HeightFieldMaps,
  settings: OpticsSettings,
  isDielectric: boolean,
): Optics {
  const isRelative = settings.energy === 'relative'
  const [layers, rows, columns] = arrayOf(terms, 'terms').spec.shape as [number, number, number]
  const [, samples] = arrayOf(terms, 'coefficients').spec.shape as [number, number]
  const isLineSum = settings.method === 'line-sum'
  const nodes = isLineSum
    ? constantOf(lobes, 'wide_lobe_nodes')[0]!
    : wavelengthsOfLoop(settings.wavelengthStep)
  // Relative to a flat surface of the same metal, its reflectance cancels.
  const metal = isRelative || isDielectric ? null : settings.metal
  const spectra = new SpectralTextures(lobes, metals, metal)
  const { defines, uniforms } = spectrumOptics(lobes, settings)
  const textures = termTextures(terms)
  return {
    defines: {
      ...defines,
      LIGHT_NODES: nodes,
      LINES_X: columns - 1,
      LINES_Y: (rows - 1) / 2,
      TERM_PAIRS: layers,
      SERIES_MAX: floatLiteral(constantOf(terms, 'max_phase')[0]!),
      SERIES_SAMPLES: samples,
      SERIES_START: floatLiteral(seriesStart(terms)),
      ...(isLineSum && { LINE_SUM: '' }),
      ...(isRelative && { ENERGY_RELATIVE: '' }),
    },
    uniforms: {
      ...uniforms,
      uLightNodes: { value: spectra.nodes(nodes, isLineSum ? 'weighted' : 'uniform') },
      uLobeTable: { value: spectra.lobe() },
      uTerms: { value: textures.terms },
      uTermCoefficients: { value: textures.coefficients },
      uReliefAmplitude: { value: constantOf(terms, 'amplitude')[0]! },
      uPatch: {
        value: new Vector2(constantOf(terms, 'period_x')[0], constantOf(terms, 'period_y')[0]),
      },
    },
    features: describeOptics(settings, constantOf(terms, 'terms')[0]!),
    underLights: (angularRadius) =>
      interference(!isLineSum && angularRadius === 0 && settings.roughness === 0),
  }
}

/** A term whose coefficient is below this adds nothing that is seen: the terms themselves are at most 1. */
const NEGLIGIBLE = 1e-4

/** The least b for which b + x/2 pairs of terms hold every coefficient that counts at x. */
function seriesStart(map: LoadedMap): number {
  const array = arrayOf(map, 'coefficients')
  const values = valuesOf(array)
  const [, axis] = array.spec.axes
  let start = 1
  for (let i = 0; i < values.length; i++) {
    if (Math.abs(values[i]!) < NEGLIGIBLE) continue
    const pair = Math.floor(Math.floor(i / axis!.size) / 2)
    start = Math.max(start, pair + 1 - parameterFromTexel(axis!, i % axis!.size) / 2)
  }
  return start
}

function interference(included: boolean): LightOptics {
  const why = included
    ? 'nothing blurs the lines of the spectrum but the coherence window'
    : 'roughness, a light or the method takes the lines of the spectrum one by one: their powers are added'
  return {
    defines: { BLURRED: !included },
    features: [{ feature: 'interference of neighbouring lines', included, why }],
  }
}

function describeOptics(settings: OpticsSettings, terms: number): Feature[] {
  const { method, energy, wavelengthStep, roughness } = settings
  return [
    {
      feature: `series of ${terms} terms`,
      included: true,
      why: `method is '${method}', and the map was baked with as many`,
    },
    {
      feature: 'wavelength loop',
      included: method !== 'line-sum',
      why:
        method === 'line-sum' ? `method is '${method}'` : `in steps of ${wavelengthStep * 1000} nm`,
    },
    {
      feature: "the metal's colour",
      included: energy !== 'relative',
      why: `energy is '${energy}'`,
    },
    { feature: 'roughness', included: roughness > 0, why: `the surface tilts by ${roughness} rad` },
    {
      feature: 'light of the environment',
      included: false,
      why: 'a height field diffracts the light of lamps alone',
    },
  ]
}
