import efficiency from '../../shaders/efficiency.glsl?raw'
import grating from '../../shaders/grating.glsl?raw'
import propagation from '../../shaders/propagation.glsl?raw'
import spectrum from '../../shaders/spectrum.glsl?raw'
import surfacePoint from '../../shaders/surface-point.glsl?raw'

/** The optics of gratings, by the names they include each other by. */
export const opticsShaders: Record<string, string> = {
  'efficiency.glsl': efficiency,
  'grating.glsl': grating,
  'propagation.glsl': propagation,
  'spectrum.glsl': spectrum,
  'surface-point.glsl': surfacePoint,
}
