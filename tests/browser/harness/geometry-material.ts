import { GLSL3, ShaderMaterial, TangentSpaceNormalMap, type Texture } from 'three'
import type { DiffractionMaterial } from '../../../web'
import { fragmentShader } from '../../../web/glsl/material-shaders'
import geometryFragment from './geometry.frag.glsl?raw'

/** Writes the geometry a material sees to five targets, through the same vertex stage and the same uniforms. */
export class GeometryMaterial extends ShaderMaterial {
  readonly anisotropy = 1
  readonly normalMapType = TangentSpaceNormalMap
  readonly normalMap: Texture | null
  readonly bumpMap: Texture | null

  constructor(source: DiffractionMaterial) {
    super({
      glslVersion: GLSL3,
      vertexShader: source.vertexShader,
      fragmentShader: fragmentShader(source.surface, geometryFragment),
      defines: { ...source.surface.defines },
      uniforms: source.uniforms,
      side: source.side,
    })
    this.normalMap = source.normalMap
    this.bumpMap = source.bumpMap
  }
}
