import blurredEnvironment from '../../shaders/blurred-environment.glsl?raw'
import coat from '../../shaders/coat.glsl?raw'
import environment from '../../shaders/environment.glsl?raw'
import fresnel from '../../shaders/fresnel.glsl?raw'
import gamut from '../../shaders/gamut.glsl?raw'
import lights from '../../shaders/lights.glsl?raw'
import fragment from '../../shaders/material.frag.glsl?raw'
import vertex from '../../shaders/material.vert.glsl?raw'
import surfacePoint from '../../shaders/surface-point.glsl?raw'
import tangentFrame from '../../shaders/tangent-frame.glsl?raw'
import type { Surface } from '../surfaces/surface.ts'
import { resolveIncludes } from './include.ts'

/** The vertex stage, the same for every surface. */
export const vertexShader = vertex

/** How an environment is read, by the names its files include each other by. */
export const environmentShaders = {
  'blurred-environment.glsl': blurredEnvironment,
  'environment.glsl': environment,
}

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
