import blurredEnvironment from '../../shaders/blurred-environment.glsl?raw'
import diffractedLight from '../../shaders/diffracted-light.glsl?raw'
import environment from '../../shaders/environment.glsl?raw'
import fresnel from '../../shaders/fresnel.glsl?raw'
import gamut from '../../shaders/gamut.glsl?raw'
import surfacePoint from '../../shaders/surface-point.glsl?raw'
import tangentFrame from '../../shaders/tangent-frame.glsl?raw'
import type { Surface } from '../surfaces/surface.ts'

/** How an environment is read, by the names its files include each other by. */
export const environmentShaders = {
  'blurred-environment.glsl': blurredEnvironment,
  'environment.glsl': environment,
}

/** What any fragment stage with that surface may include; its own GLSL is `surface.glsl`. */
export function surfaceShaders(surface: Surface): Record<string, string> {
  return {
    ...surface.glslFiles,
    ...environmentShaders,
    'diffracted-light.glsl': diffractedLight,
    'fresnel.glsl': fresnel,
    'gamut.glsl': gamut,
    'surface-point.glsl': surfacePoint,
    'surface.glsl': surface.glsl,
    'tangent-frame.glsl': tangentFrame,
  }
}
