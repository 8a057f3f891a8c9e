import blurredEnvironment from '../../shaders/blurred-environment.glsl?raw'
import coat from '../../shaders/coat.glsl?raw'
import environmentBlur from '../../shaders/environment-blur.frag.glsl?raw'
import environment from '../../shaders/environment.glsl?raw'
import fresnel from '../../shaders/fresnel.glsl?raw'
import gamut from '../../shaders/gamut.glsl?raw'
import lights from '../../shaders/lights.glsl?raw'
import fragment from '../../shaders/material.frag.glsl?raw'
import vertex from '../../shaders/material.vert.glsl?raw'
import planarBlur from '../../shaders/planar-blur.frag.glsl?raw'
import planarEnvironment from '../../shaders/planar-environment.frag.glsl?raw'
import surfacePoint from '../../shaders/surface-point.glsl?raw'
import tangentFrame from '../../shaders/tangent-frame.glsl?raw'
import type { Surface } from '../surfaces/surface.ts'
import { resolveIncludes } from './include.ts'
import { gratingShaders } from './grating-shaders.ts'

/** The vertex stage, the same for every surface. */
export const vertexShader = vertex

const environmentShaders = {
  'blurred-environment.glsl': blurredEnvironment,
  'environment.glsl': environment,
}

/** The fragment stage that fills the layers of shaders/blurred-environment.glsl. */
export const environmentBlurShader = resolveIncludes(environmentBlur, environmentShaders)

/** The fragment stages that fill the table of shaders/planar-environment.glsl, the same for all gratings. */
export const planarBlurShader = resolveIncludes(planarBlur, {
  ...gratingShaders,
  ...environmentShaders,
})
export const planarEnvironmentShader = resolveIncludes(planarEnvironment, gratingShaders)

/** A fragment stage with a surface's GLSL in the place of `surface.glsl`; the material's own by default. */
export function fragmentShader(surface: Surface, source: string = fragment): string {
  return resolveIncludes(source, {
    ...surface.glslFiles,
    ...environmentShaders,
    'coat.glsl': coat,
    'fresnel.glsl': fresnel,
    'gamut.glsl': gamut,
    'lights.glsl': lights,
    'surface-point.glsl': surfacePoint,
    'surface.glsl': surface.glsl,
    'tangent-frame.glsl': tangentFrame,
  })
}
