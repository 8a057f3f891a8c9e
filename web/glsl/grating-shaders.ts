import efficiency from '../../shaders/efficiency.glsl?raw'
import grating from '../../shaders/grating.glsl?raw'
import kirchhoff from '../../shaders/kirchhoff.glsl?raw'
import lobe from '../../shaders/lobe.glsl?raw'
import planarDirections from '../../shaders/planar-directions.glsl?raw'
import planarEnvironment from '../../shaders/planar-environment.glsl?raw'
import propagation from '../../shaders/propagation.glsl?raw'
import spectrum from '../../shaders/spectrum.glsl?raw'
import surfacePoint from '../../shaders/surface-point.glsl?raw'

/** The optics of gratings and of foils, by the names they include each other by. */
export const gratingShaders: Record<string, string> = {
  'efficiency.glsl': efficiency,
  'grating.glsl': grating,
  'kirchhoff.glsl': kirchhoff,
  'lobe.glsl': lobe,
  'planar-directions.glsl': planarDirections,
  'planar-environment.glsl': planarEnvironment,
  'propagation.glsl': propagation,
  'spectrum.glsl': spectrum,
  'surface-point.glsl': surfacePoint,
}
