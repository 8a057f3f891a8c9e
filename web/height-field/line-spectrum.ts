import { DataArrayTexture, DataTexture, FloatType, HalfFloatType, RGBAFormat, Vector2 } from 'three'
import { floatLiteral } from '../glsl/float-literal'
import { parameterFromTexel } from '../maps/axes'
import { arrayOf, constantOf, valuesOf, type LoadedMap } from '../maps/load'
import { sharedTexture, unfiltered } from '../maps/shared-texture'
import { wavelengthsOfLoop } from '../spectrum/spectrum-optics'
import type { LightOptics, OpticsSettings } from '../surfaces/surface'
import type { Pattern } from './optics'

/** Defines and uniforms of shaders/line-spectrum.glsl. */
export function lineSpectrum(
  relief: LoadedMap,
  lobes: LoadedMap,
  { method, wavelengthStep, roughness }: OpticsSettings,
): Pattern {
  const isLineSum = method === 'line-sum'
  const [layers, rows, columns] = arrayOf(relief, 'terms').spec.shape as [number, number, number]
  const [, samples] = arrayOf(relief, 'coefficients').spec.shape as [number, number]
  const constant = (name: string): number => constantOf(relief, name)[0]!
  return {
    defines: {
      LINES_X: columns - 1,
      LINES_Y: (rows - 1) / 2,
      TERM_PAIRS: layers,
      SERIES_MAX: floatLiteral(constant('max_phase')),
      SERIES_SAMPLES: samples,
      SERIES_START: floatLiteral(seriesStart(relief)),
      ...(isLineSum && { LINE_SUM: '' }),
    },
    uniforms: {
      uTerms: { value: termsTexture(relief) },
      uTermCoefficients: { value: coefficientsTexture(relief) },
      uReliefAmplitude: { value: constant('amplitude') },
      uPatch: { value: new Vector2(constant('period_x'), constant('period_y')) },
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
    ],
    underLights: (angularRadius) =>
      interference(!isLineSum && angularRadius === 0 && roughness === 0),
    nodes: isLineSum
      ? { count: constantOf(lobes, 'wide_lobe_nodes')[0]!, placement: 'weighted' }
      : { count: wavelengthsOfLoop(wavelengthStep), placement: 'uniform' },
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
