import { DataTexture, FloatType, type Scene } from 'three'
import type { DiffractionMaterial } from '../../../web'
import { buildLight } from './build-scene'
import { loadEnvironment } from './environment'
import type { ForcedParts } from './scene-description'

/**
 * Puts into a material's program what its scene has no use for, by three's own hooks: the material itself has no option
 * to ask for it. What is put in adds nothing to the picture.
 */
export async function force(
  scene: Scene,
  material: DiffractionMaterial,
  { defines, lights = [], environment, normalMap }: ForcedParts,
): Promise<void> {
  if (defines !== undefined) {
    material.onBeforeCompile = (parameters) => {
      parameters.defines = { ...parameters.defines, ...defines }
    }
    material.customProgramCacheKey = () => JSON.stringify(defines)
  }
  for (const light of lights) scene.add(buildLight(light))
  if (environment !== undefined) {
    const texture = await loadEnvironment(environment)
    material.envMap = texture
    material.envMapIntensity = environment.intensity ?? 1
    material.addEventListener('dispose', () => {
      texture.dispose()
    })
  }
  if (normalMap === true) {
    // Halves of 1 are exact as floats, and stand for a slope of zero.
    const flat = new DataTexture(new Float32Array([0.5, 0.5, 1, 1]), 1, 1)
    flat.type = FloatType
    flat.needsUpdate = true
    material.normalMap = flat
    material.addEventListener('dispose', () => {
      flat.dispose()
    })
  }
}
