import environmentBlur from '../../shaders/environment-blur.frag.glsl?raw'
import planarBlur from '../../shaders/planar-blur.frag.glsl?raw'
import planarEnvironment from '../../shaders/planar-environment.frag.glsl?raw'
import { gratingShaders } from './grating-shaders.ts'
import { resolveIncludes } from './include.ts'
import { environmentShaders } from './surface-shaders.ts'

/** The fragment stage that fills the layers of shaders/blurred-environment.glsl. */
export const environmentBlurShader = resolveIncludes(environmentBlur, environmentShaders)

/** The fragment stages that fill the table of shaders/planar-environment.glsl, the same for all gratings. */
export const planarBlurShader = resolveIncludes(planarBlur, {
  ...gratingShaders,
  ...environmentShaders,
})
export const planarEnvironmentShader = resolveIncludes(planarEnvironment, gratingShaders)
