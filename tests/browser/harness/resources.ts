import {
  DirectionalLight,
  FloatType,
  Mesh,
  PerspectiveCamera,
  PlaneGeometry,
  Scene,
  SphereGeometry,
  WebGLRenderer,
  WebGLRenderTarget,
} from 'three'
import { DiffractionMaterial, ProgressiveRefinement } from '../../../web'
import { buildSurface } from './build-scene'
import { loadEnvironment } from './environment'
import type { MaterialDescription, SurfaceDescription } from './scene-description'

type Options = Omit<MaterialDescription, 'color'>

/** WebGL objects that are alive. */
export interface Alive {
  textures: number
  programs: number
  framebuffers: number
}

/** Materials that show what a first one shows. */
const MORE = 3

const KINDS = { textures: 'Texture', programs: 'Program', framebuffers: 'Framebuffer' } as const

/** Counts what a renderer creates and has not deleted. */
export function watch(renderer: WebGLRenderer): { alive: Alive; uploads: () => number } {
  const gl = renderer.getContext() as unknown as Record<string, (...args: unknown[]) => unknown>
  const alive: Alive = { textures: 0, programs: 0, framebuffers: 0 }
  for (const [name, kind] of Object.entries(KINDS)) {
    const [create, remove] = [gl[`create${kind}`]!.bind(gl), gl[`delete${kind}`]!.bind(gl)]
    gl[`create${kind}`] = () => {
      alive[name as keyof Alive]++
      return create()
    }
    gl[`delete${kind}`] = (object) => {
      if (object !== null && object !== undefined) alive[name as keyof Alive]--
      remove(object)
    }
  }
  let uploads = 0
  for (const name of ['texSubImage2D', 'texSubImage3D', 'texImage2D', 'texImage3D']) {
    const upload = gl[name]!.bind(gl)
    gl[name] = (...args) => {
      // Memory of a render target is no upload.
      if (args.at(-1) !== null) uploads++
      return upload(...args)
    }
  }
  return { alive, uploads: () => uploads }
}

export interface ResourceReport {
  /** Before anything of the material is drawn, while it is, and after all is disposed of. */
  before: Alive
  during: Alive
  after: Alive
  /** Uploads of a first material, and of as many more as MORE that show the same surface. */
  uploads: [number, number]
}

/** Draws a surface on a sphere and on a card under a light and an environment, then disposes of all. */
export async function countResources(
  description: SurfaceDescription,
  options: Options,
): Promise<ResourceReport> {
  const renderer = new WebGLRenderer()
  renderer.setSize(32, 32)
  const { alive, uploads } = watch(renderer)
  const scene = new Scene()
  const camera = new PerspectiveCamera(50, 1, 0.1, 100)
  camera.position.z = 4
  // What three keeps for itself.
  renderer.render(scene, camera)
  const before = { ...alive }

  const surface = await buildSurface(description)
  const make = async (): Promise<DiffractionMaterial> => {
    const material = new DiffractionMaterial({ ...options, surface, mapsPath: '/maps/baked/' })
    await material.ready
    return material
  }
  const geometries = [new SphereGeometry(1, 16, 8), new PlaneGeometry(1, 1)]
  const sun = new DirectionalLight()
  sun.position.set(0.3, 0, 1)
  scene.add(sun)
  scene.environment = await loadEnvironment({ asset: 'studio' })
  const environment = scene.environment
  const frames = (count: number): void => {
    for (let frame = 0; frame < count; frame++) renderer.render(scene, camera)
  }
  const materials = [await make()]
  const card = new Mesh(geometries[1], materials[0])
  scene.add(card)
  frames(4)
  scene.remove(card)
  scene.add(new Mesh(geometries[0], materials[0]))
  frames(4)
  const refinement = new ProgressiveRefinement(renderer, { frames: 2 })
  while (refinement.frame(scene, camera));
  refinement.show()
  const first = uploads()
  for (let i = 0; i < MORE; i++) {
    const material = await make()
    materials.push(material)
    scene.add(new Mesh(geometries[0], material))
  }
  frames(2)
  const during = { ...alive }
  const rest = uploads() - first

  refinement.dispose()
  for (const material of materials) material.dispose()
  for (const geometry of geometries) geometry.dispose()
  environment.dispose()
  scene.clear()
  const after = { ...alive }
  renderer.dispose()
  renderer.forceContextLoss()
  return { before, during, after, uploads: [first, rest] }
}

export interface RestoredReport {
  before: Float32Array
  after: Float32Array
  /** Channels that are not 0. */
  lit: number
}

/** Draws frames, loses the context, has it restored, and draws as many. */
export async function drawRestored(
  description: SurfaceDescription,
  options: Options,
  kind: 'card' | 'sphere',
  isRefined: boolean,
): Promise<RestoredReport> {
  const renderer = new WebGLRenderer()
  const [width, height] = [48, 48]
  renderer.setSize(width, height)
  const scene = new Scene()
  const camera = new PerspectiveCamera(40, 1, 0.1, 100)
  camera.position.z = 3
  const sun = new DirectionalLight()
  sun.position.set(0.35, 0, 1)
  scene.add(sun)
  scene.environment = await loadEnvironment({ asset: 'studio' })
  const material = new DiffractionMaterial({
    ...options,
    surface: await buildSurface(description),
    mapsPath: '/maps/baked/',
    gamut: 'signed',
  })
  await material.ready
  const geometry = kind === 'card' ? new PlaneGeometry(2, 2) : new SphereGeometry(1, 64, 32)
  scene.add(new Mesh(geometry, material))
  const refinement = new ProgressiveRefinement(renderer, { frames: 4 })
  const target = new WebGLRenderTarget(width, height, { type: FloatType })

  const draw = (): Float32Array => {
    const pixels = new Float32Array(4 * width * height)
    if (isRefined) {
      refinement.begin(width, height)
      while (refinement.frame(scene, camera));
      renderer.readRenderTargetPixels(refinement.mean, 0, 0, width, height, pixels)
      return pixels
    }
    for (let frame = 0; frame < 4; frame++) {
      renderer.setRenderTarget(target)
      renderer.clear()
      renderer.render(scene, camera)
    }
    renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels)
    renderer.setRenderTarget(null)
    return pixels
  }

  const before = draw()
  const extension = renderer.getContext().getExtension('WEBGL_lose_context')!
  const event = (name: string): Promise<void> =>
    new Promise((resolve) => {
      renderer.domElement.addEventListener(
        name,
        () => {
          // After three's own listener.
          setTimeout(resolve)
        },
        { once: true },
      )
    })
  const lost = event('webglcontextlost')
  extension.loseContext()
  await lost
  const restored = event('webglcontextrestored')
  extension.restoreContext()
  await restored
  const after = draw()
  renderer.dispose()
  renderer.forceContextLoss()
  return { before, after, lit: before.filter((value) => value !== 0).length }
}
