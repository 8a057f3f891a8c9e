import {
  Color,
  Mesh,
  MeshPhysicalMaterial,
  MeshStandardMaterial,
  Scene,
  WebGLRenderTarget,
  type BufferGeometry,
  type Material,
  type WebGLRenderer,
} from 'three'
import { DiffractionMaterial } from '../../../web'
import { buildCamera, buildGeometry, buildLight, buildSurface, placeMesh } from './build-scene'
import { loadEnvironment } from './environment'
import { force } from './force'
import type {
  ForcedParts,
  MaterialDescription,
  SceneDescription,
  SurfaceDescription,
} from './scene-description'

export type TimedMaterial =
  | { name: string; kind: 'standard' | 'iridescent'; roughness?: number; metalness?: number }
  | {
      name: string
      kind: 'diffraction'
      material?: MaterialDescription
      /** In place of the scene's own. */
      surface?: SurfaceDescription
      force?: ForcedParts
    }

export interface TimingRequest {
  /** Mesh, camera, lights and environment that all the materials share. */
  scene: SceneDescription
  materials: TimedMaterial[]
  /** Frames of each material, of a slow one fewer; the shortest counts. */
  frames: number
}

interface TimedScene {
  name: string
  scene: Scene
  best: number
  spent: number
}

/** The page's clock ticks every 0.1 ms: shorter frames are drawn again until this much has passed, ms. */
const SHORTEST_MEASUREMENT = 10

/**
 * A material that has taken this long, ms, in at least so many frames is measured: a frame of hundreds of milliseconds is
 * a mean already, and would hold up the others.
 */
const LONGEST_MEASUREMENT = 1500
const FEWEST_FRAMES = 5

/**
 * Shortest frame of each material, ms. Frames are interleaved, so that a machine that slows down slows all of them, and
 * each is waited for by reading one pixel: timer queries say nothing of software rendering.
 */
export async function timeMaterials(
  renderer: WebGLRenderer,
  { scene: description, materials, frames }: TimingRequest,
): Promise<Record<string, number>> {
  const [width, height] = description.size
  const target = new WebGLRenderTarget(width, height)
  const camera = buildCamera(description)
  const environment = description.environment
    ? await loadEnvironment(description.environment)
    : null
  const timed: TimedScene[] = []
  for (const request of materials) {
    const scene = new Scene()
    if (environment !== null) scene.environment = environment
    for (const light of description.lights ?? []) {
      const built = buildLight(light)
      scene.add(built)
      if ('target' in built) scene.add(built.target)
    }
    const material = await buildMaterial(request, description)
    if (material instanceof DiffractionMaterial && 'force' in request && request.force)
      await force(scene, material, request.force)
    const mesh = new Mesh(buildGeometry(description.mesh), material)
    placeMesh(mesh, description.mesh)
    scene.add(mesh)
    timed.push({ name: request.name, scene, best: Infinity, spent: 0 })
  }

  const pixel = new Uint8Array(4)
  const gl = renderer.getContext()
  renderer.setRenderTarget(target)
  // The first frames compile programs and upload textures.
  for (let frame = -2; frame < frames; frame++)
    for (const entry of timed) {
      if (frame >= FEWEST_FRAMES && entry.spent > LONGEST_MEASUREMENT) continue
      const start = performance.now()
      let elapsed: number
      let count = 0
      do {
        renderer.render(entry.scene, camera)
        gl.finish()
        renderer.readRenderTargetPixels(target, 0, 0, 1, 1, pixel)
        elapsed = performance.now() - start
        count++
      } while (elapsed < SHORTEST_MEASUREMENT)
      if (frame < 0) continue
      entry.best = Math.min(entry.best, elapsed / count)
      entry.spent += elapsed
    }
  renderer.setRenderTarget(null)
  target.dispose()
  environment?.dispose()
  for (const { scene } of timed)
    scene.traverse((object) => {
      if (!(object instanceof Mesh)) return
      const { geometry, material } = object as Mesh<BufferGeometry, Material>
      geometry.dispose()
      material.dispose()
    })
  return Object.fromEntries(timed.map(({ name, best }) => [name, best]))
}

async function buildMaterial(
  request: TimedMaterial,
  description: SceneDescription,
): Promise<Material> {
  if (request.kind === 'diffraction') {
    const { color, ...options } = request.material ?? description.material ?? {}
    const material = new DiffractionMaterial({
      mapsPath: '/maps/baked/',
      ...options,
      ...(color && { color: new Color(...color) }),
      surface: await buildSurface(request.surface ?? description.surface),
    })
    await material.ready
    return material
  }
  const { roughness = 0.2, metalness = 1 } = request
  return request.kind === 'standard'
    ? new MeshStandardMaterial({ roughness, metalness })
    : new MeshPhysicalMaterial({ roughness, metalness, iridescence: 1 })
}
