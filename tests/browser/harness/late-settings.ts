import {
  FloatType,
  Mesh,
  PerspectiveCamera,
  Scene,
  SphereGeometry,
  WebGLRenderer,
  WebGLRenderTarget,
} from 'three'
import { DiffractionMaterial, type OpticsSettings } from '../../../web'
import { buildSurface } from './build-scene'
import { loadEnvironment } from './environment'
import { watch } from './resources'
import type { SurfaceDescription } from './scene-description'

/** Radiance of a sphere under an environment, four numbers a pixel. */
export interface LateReport {
  before: Float32Array
  /** In the frame after settings have changed. */
  meanwhile: Float32Array
  /** Once the material is ready. */
  after: Float32Array
  /** By a material that has had these settings from the start. */
  fresh: Float32Array
  /** Textures that are alive before, and after. */
  textures: [number, number]
}

const SIZE = 48

/** Changes settings of a material that is on show, and draws at once and when it is ready. */
export async function drawLate(
  description: SurfaceDescription,
  settings: Partial<OpticsSettings>,
): Promise<LateReport> {
  const renderer = new WebGLRenderer()
  const { alive } = watch(renderer)
  const scene = new Scene()
  scene.environment = await loadEnvironment({ asset: 'studio' })
  const camera = new PerspectiveCamera(40, 1, 0.1, 100)
  camera.position.z = 3
  const target = new WebGLRenderTarget(SIZE, SIZE, { type: FloatType })
  const geometry = new SphereGeometry(1, 64, 32)
  const surface = await buildSurface(description)
  const show = (options: Partial<OpticsSettings>): DiffractionMaterial => {
    const material = new DiffractionMaterial({
      ...options,
      surface,
      mapsPath: '/maps/baked/',
      gamut: 'signed',
    })
    scene.add(new Mesh(geometry, material))
    return material
  }
  const draw = (): Float32Array => {
    const pixels = new Float32Array(4 * SIZE * SIZE)
    renderer.setRenderTarget(target)
    renderer.clear()
    renderer.render(scene, camera)
    renderer.readRenderTargetPixels(target, 0, 0, SIZE, SIZE, pixels)
    return pixels
  }

  const material = show({})
  await material.ready
  const before = draw()
  const textures = alive.textures
  Object.assign(material, settings)
  const meanwhile = draw()
  await material.ready
  const after = draw()
  const texturesAfter = alive.textures
  scene.clear()
  await show(settings).ready
  const fresh = draw()
  renderer.dispose()
  renderer.forceContextLoss()
  return { before, meanwhile, after, fresh, textures: [textures, texturesAfter] }
}
