import bakedPattern from '../../shaders/baked-pattern.glsl?raw'
import efficiency from '../../shaders/efficiency.glsl?raw'
import environmentSamples from '../../shaders/environment-samples.glsl?raw'
import expansion from '../../shaders/expansion.glsl?raw'
import fresnel from '../../shaders/fresnel.glsl?raw'
import grating from '../../shaders/grating.glsl?raw'
import heightField from '../../shaders/height-field.glsl?raw'
import kirchhoff from '../../shaders/kirchhoff.glsl?raw'
import lineSpectrum from '../../shaders/line-spectrum.glsl?raw'
import lobe from '../../shaders/lobe.glsl?raw'
import planarDirections from '../../shaders/planar-directions.glsl?raw'
import planarEnvironment from '../../shaders/planar-environment.glsl?raw'
import propagation from '../../shaders/propagation.glsl?raw'
import spectrum from '../../shaders/spectrum.glsl?raw'
import surfacePoint from '../../shaders/surface-point.glsl?raw'

/** The optics of surfaces, by the names they include each other by. */
export const opticsShaders: Record<string, string> = {
  'baked-pattern.glsl': bakedPattern,
  'efficiency.glsl': efficiency,
  'environment-samples.glsl': environmentSamples,
  'expansion.glsl': expansion,
  'fresnel.glsl': fresnel,
  'grating.glsl': grating,
  'height-field.glsl': heightField,
  'kirchhoff.glsl': kirchhoff,
  'line-spectrum.glsl': lineSpectrum,
  'lobe.glsl': lobe,
  'planar-directions.glsl': planarDirections,
  'planar-environment.glsl': planarEnvironment,
  'propagation.glsl': propagation,
  'spectrum.glsl': spectrum,
  'surface-point.glsl': surfacePoint,
}
