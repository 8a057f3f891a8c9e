import bakedPattern from '../../shaders/baked-pattern.glsl?raw'
import environmentSamples from '../../shaders/environment-samples.glsl?raw'
import expansion from '../../shaders/expansion.glsl?raw'
import fresnel from '../../shaders/fresnel.glsl?raw'
import heightField from '../../shaders/height-field.glsl?raw'
import kirchhoff from '../../shaders/kirchhoff.glsl?raw'
import lineSpectrum from '../../shaders/line-spectrum.glsl?raw'
import lobe from '../../shaders/lobe.glsl?raw'
import spectrum from '../../shaders/spectrum.glsl?raw'
import surfacePoint from '../../shaders/surface-point.glsl?raw'

/** The optics of height fields, by the names they include each other by. */
export const heightFieldShaders: Record<string, string> = {
  'baked-pattern.glsl': bakedPattern,
  'environment-samples.glsl': environmentSamples,
  'expansion.glsl': expansion,
  'fresnel.glsl': fresnel,
  'height-field.glsl': heightField,
  'kirchhoff.glsl': kirchhoff,
  'line-spectrum.glsl': lineSpectrum,
  'lobe.glsl': lobe,
  'spectrum.glsl': spectrum,
  'surface-point.glsl': surfacePoint,
}
