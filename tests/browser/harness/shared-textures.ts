import {
  DirectionalLight,
  Mesh,
  MeshStandardMaterial,
  PerspectiveCamera,
  Scene,
  SphereGeometry,
  WebGLRenderer,
  type Material,
} from 'three'
import { DiffractionMaterial, diffractionLayer, Grating } from '../../../web'
import { buildSurface } from './build-scene'
import { loadEnvironment } from './environment'
import { watch } from './resources'
import type { SurfaceDescription } from './scene-description'

/** What a frame leaves: textures that are alive, and uploads that it made. */
export interface Frame {
  textures: number
  uploads: number
}

const mapsPath = '/maps/baked/'
const grating = new Grating({ period: 1.6, height: 0.1 })

interface WatchedScene {
  show: (material: Material) => Mesh
  draw: () => Frame
  /** A frame after all that is three's own and the scene's has been uploaded. */
  empty: Frame
  close: () => void
}

/** Spheres under a light and an environment. */
async function watchedScene(): Promise<WatchedScene> {
  const renderer = new WebGLRenderer()
  renderer.setSize(32, 32)
  const { alive, uploads } = watch(renderer)
  const scene = new Scene()
  const camera = new PerspectiveCamera(50, 1, 0.1, 100)
  camera.position.z = 4
  scene.add(new DirectionalLight())
  const environment = await loadEnvironment({ asset: 'studio' })
  scene.environment = environment
  const geometry = new SphereGeometry(1, 16, 8)
  const show = (material: Material): Mesh => {
    const mesh = new Mesh(geometry, material)
    scene.add(mesh)
    return mesh
  }
  const draw = (): Frame => {
    const before = uploads()
    renderer.render(scene, camera)
    return { textures: alive.textures, uploads: uploads() - before }
  }
  const material = new DiffractionMaterial({ surface: grating, mapsPath })
  await material.ready
  const meshes = [show(new MeshStandardMaterial()), show(material)]
  draw()
  for (const mesh of meshes) take(mesh)
  const close = (): void => {
    geometry.dispose()
    environment.dispose()
    renderer.dispose()
    renderer.forceContextLoss()
  }
  return { show, draw, empty: draw(), close }
}

/** Takes a mesh out of its scene and disposes of its material. */
function take(mesh: Mesh): void {
  mesh.removeFromParent()
  ;(mesh.material as Material).dispose()
}

export interface SharingReport {
  empty: Frame
  /** With the first material, then with all of them. */
  first: Frame
  all: Frame
  /** After each that went. */
  rests: Frame[]
}

/**
 * Shows a surface by materials, each second of which is a layer on one of three's, and each has a surface of its own from the
 * same maps; then disposes of them one by one.
 *
 * @param order - in which the materials go
 */
export async function countSharing(
  description: SurfaceDescription,
  order: readonly number[],
): Promise<SharingReport> {
  const { show, draw, empty, close } = await watchedScene()
  const make = async (number: number): Promise<Material> => {
    const options = { surface: await buildSurface(description), mapsPath }
    if (number % 2 === 1) {
      const base = new MeshStandardMaterial()
      await diffractionLayer(base, options).ready
      return base
    }
    const material = new DiffractionMaterial(options)
    await material.ready
    return material
  }
  const meshes = [show(await make(0))]
  const first = draw()
  while (meshes.length < order.length) meshes.push(show(await make(meshes.length)))
  const all = draw()
  const rests = order.map((which) => {
    take(meshes[which]!)
    return draw()
  })
  close()
  return { empty, first, all, rests }
}

export interface ReplacingReport {
  empty: Frame
  /** A material and a layer with a grating. */
  gratings: Frame
  /** The material with the surface, then the layer too. */
  one: Frame
  both: Frame
  /** The material with the grating again, then the layer too, and a frame later. */
  oneBack: Frame
  bothBack: Frame
  later: Frame
  /** The grating of another metal, by the material alone, and of its own again. */
  gold: Frame
  aluminium: Frame
  /** Drawn after both were disposed of. */
  redrawn: Frame
  gone: Frame
}

/** Puts a surface in a grating's place, and the grating in that of the surface. */
export async function countReplacing(description: SurfaceDescription): Promise<ReplacingReport> {
  const { show, draw, empty, close } = await watchedScene()
  const surface = await buildSurface(description)
  const material = new DiffractionMaterial({ surface: grating, mapsPath })
  const base = new MeshStandardMaterial()
  const layer = diffractionLayer(base, { surface: grating, mapsPath })
  const meshes = [show(material), show(base)]
  const settled = async (): Promise<Frame> => {
    await Promise.all([material.ready, layer.ready])
    return draw()
  }
  const gratings = await settled()
  material.surface = surface
  const one = await settled()
  layer.set({ surface })
  const both = await settled()
  material.surface = grating
  const oneBack = await settled()
  layer.set({ surface: grating })
  const bothBack = await settled()
  const later = draw()
  material.metal = 'gold'
  const gold = await settled()
  material.metal = 'aluminium'
  const aluminium = await settled()
  material.dispose()
  base.dispose()
  const redrawn = draw()
  layer.remove()
  for (const mesh of meshes) take(mesh)
  const gone = draw()
  close()
  return {
    ...{ empty, gratings, one, both, oneBack, bothBack, later },
    ...{ gold, aluminium, redrawn, gone },
  }
}
