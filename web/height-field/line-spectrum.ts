import { DataArrayTexture, DataTexture, FloatType, HalfFloatType, RGBAFormat, Vector2 } from 'three'
import { floatLiteral } from '../glsl/float-literal.ts'
import { parameterFromTexel } from '../maps/axes.ts'
import { arrayOf, constantOf, valuesOf, type LoadedMap } from '../maps/load.ts'
import { sharedTexture, unfiltered } from '../maps/shared-texture.ts'
import { wavelengthsOfLoop } from '../spectrum/spectrum-optics.ts'
import { SpectralTextures } from '../spectrum/spectral-textures.ts'
import type { LightOptics, Metal, OpticsSettings } from '../surfaces/surface.ts'
import { cutWindow, type Tiles } from './cut-window.ts'
import type { HeightFieldMaps, Pattern } from './optics.ts'

/**
 * Defines and uniforms of shaders/line-spectrum.glsl.
 *
 * @param metal - whose colour the light's spectrum is seen in; null: a perfect mirror
 * @param tiles - how many patches cut the coherence window, if any do
 */
export function lineSpectrum(
  { relief, lobes, metals }: HeightFieldMaps,
  { method, wavelengthStep, roughness, coherence }: OpticsSettings,
  metal: Metal | null,
  tiles: Tiles | null,
): Pattern {
  const isLineSum = method === 'line-sum'
  const spectra = new SpectralTextures(lobes, metals, metal)
  const nodes = isLineSum
    ? constantOf(lobes, 'wide_lobe_nodes')[0]!
    : wavelengthsOfLoop(wavelengthStep)
  const [layers, rows, columns] = arrayOf(relief, 'terms').spec.shape as [number, number, number]
  const [, samples] = arrayOf(relief, 'coefficients').spec.shape as [number, number]
  const constant = (name: string): number => constantOf(relief, name)[0]!
  const period = [constant('period_x'), constant('period_y')] as const
  const cut = tiles && cutWindow(tiles, period, coherence)
  return {
    defines: {
      LIGHT_NODES: nodes,
      LINES_X: columns - 1,
      LINES_Y: (rows - 1) / 2,
      TERM_PAIRS: layers,
      SERIES_MAX: floatLiteral(constant('max_phase')),
      SERIES_SAMPLES: samples,
      SERIES_START: floatLiteral(seriesStart(relief)),
      ...(isLineSum && { LINE_SUM: '' }),
      ...cut?.defines,
    },
    uniforms: {
      uLightNodes: { value: spectra.nodes(nodes, isLineSum ? 'weighted' : 'uniform') },
      ...(isLineSum && { uLobeTable: { value: spectra.lobe() } }),
      uTerms: { value: termsTexture(relief) },
      uTermCoefficients: { value: coefficientsTexture(relief) },
      uReliefAmplitude: { value: constant('amplitude') },
      uPatch: { value: new Vector2(...period) },
      ...cut?.uniforms,
    },
    features: [
      {
        feature: `series of ${constant('terms')} terms`,
        included: true,
        why: `method is '${method}', and the map was baked with as many`,
      },
      {
        feature: 'wavelength loop',
        included: !isLineSum,
        why: isLineSum ? `method is '${method}'` : `in steps of ${wavelengthStep * 1000} nm`,
      },
      {
        feature: 'finite repeats',
        included: tiles !== null,
        why: tiles === null ? 'tiles is null' : `tiles is ${tiles.join(' × ')}`,
      },
    ],
    underLights: (angularRadius) =>
      interference(!isLineSum && angularRadius === 0 && roughness === 0),
  }
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

/** A term whose coefficient is below this adds nothing that is seen: the terms themselves are at most 1. */
const NEGLIGIBLE = 1e-4

/** The least b for which b + x/2 pairs of terms hold every coefficient that counts at x. */
function seriesStart(relief: LoadedMap): number {
  const array = arrayOf(relief, 'coefficients')
  const [, axis] = array.spec.axes
  let start = 1
  valuesOf(array).forEach((value, i) => {
    if (Math.abs(value) < NEGLIGIBLE) return
    const pair = Math.floor(Math.floor(i / axis!.size) / 2)
    start = Math.max(start, pair + 1 - parameterFromTexel(axis!, i % axis!.size) / 2)
  })
  return start
}

/** The spectra, a layer for each pair of terms. */
export function termsTexture(relief: LoadedMap): DataArrayTexture {
  return sharedTexture(relief, 'terms', () => {
    const { spec, data } = arrayOf(relief, 'terms')
    const [layers, height, width] = spec.shape
    const texture = new DataArrayTexture(data, width, height, layers)
    texture.format = RGBAFormat
    texture.type = spec.dtype === 'float16' ? HalfFloatType : FloatType
    return unfiltered(texture)
  })
}

/**
 * The coefficients of a pair of terms a row: a texel holds c and its step to the next argument, of the even term and
 * of the odd one, so that a linear lookup of both is one fetch.
 */
export function coefficientsTexture(relief: LoadedMap): DataTexture {
  return sharedTexture(relief, 'coefficients', () => {
    const array = arrayOf(relief, 'coefficients')
    const [terms, samples] = array.spec.shape as [number, number]
    const values = valuesOf(array)
    const pairs = Math.ceil(terms / 2)
    const texels = new Float32Array(4 * pairs * samples)
    for (let n = 0; n < terms; n++) {
      const row = values.subarray(n * samples, (n + 1) * samples)
      row.forEach((value, i) => {
        const texel = 4 * ((n >> 1) * samples + i) + 2 * (n % 2)
        texels[texel] = value
        texels[texel + 1] = (row[i + 1] ?? value) - value
      })
    }
    return unfiltered(new DataTexture(texels, samples, pairs, RGBAFormat, FloatType))
  })
}
