import coat from '../../shaders/coat.glsl?raw'
import lights from '../../shaders/lights.glsl?raw'
import fragment from '../../shaders/material.frag.glsl?raw'
import vertex from '../../shaders/material.vert.glsl?raw'
import type { Surface } from '../surfaces/surface.ts'
import { resolveIncludes } from './include.ts'
import { surfaceShaders } from './surface-shaders.ts'

/** The vertex stage, the same for every surface. */
export const vertexShader = vertex

/** A fragment stage with a surface's GLSL in the place of `surface.glsl`; the material's own by default. */
export function fragmentShader(surface: Surface, source: string = fragment): string {
  const own = { 'coat.glsl': coat, 'lights.glsl': lights }
  return resolveIncludes(source, { ...surfaceShaders(surface), ...own })
}
