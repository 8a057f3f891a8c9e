import {
  DirectionalLight,
  InstancedMesh,
  Matrix4,
  Mesh,
  MeshPhysicalMaterial,
  MeshStandardMaterial,
  PerspectiveCamera,
  PointLight,
  Scene,
  SphereGeometry,
  WebGLRenderer,
  type Material,
  type Texture,
} from 'three'
import {
  diffractionLayer,
  DiffractionMaterial,
  type DiffractionMaterialOptions,
  type OpticsSettings,
} from '../../../web'
import { buildSurface } from './build-scene'
import { loadEnvironment } from './environment'
import type { SurfaceDescription } from './scene-description'
import type { Drawn } from './three-features'

/** What one change of a scene made the renderer do when it was first drawn, and when it was drawn again. */
export interface Compilation {
  change: string
  /** Programs linked in the round in which the change was new. */
  first: number
  /** Programs linked in the rounds after it. */
  later: number
}

/** What the changes need of either kind of material. */
interface Diffracting {
  material: Material & { envMap: Texture | null }
  ready: Promise<void>
  set: (settings: Partial<OpticsSettings>) => void
  coat: (share: number) => void
}

/** Rounds through all changes; in the first each is new. */
const ROUNDS = 3
/** Frames after each change. */
const FRAMES = 2

/** Goes through everything that happens to a scene, some rounds long, and counts the programs that WebGL links. */
export async function countCompilations(
  surface: SurfaceDescription,
  drawn: Drawn,
): Promise<{
  compilations: Compilation[]
  /** Programs alive after each round. */
  programs: number[]
}> {
  const renderer = new WebGLRenderer()
  renderer.setSize(32, 32)
  const studio = await loadEnvironment({ asset: 'studio' })
  const night = await loadEnvironment({ constant: [0.1, 0.1, 0.2] })
  for (const environment of [studio, night]) letThreeFilter(environment, renderer)
  const programsBefore = renderer.info.programs!.length
  let linked = 0
  const gl = renderer.getContext()
  const link = gl.linkProgram.bind(gl)
  gl.linkProgram = (program) => {
    linked++
    link(program)
  }

  const options = { surface: await buildSurface(surface), mapsPath: '/maps/baked/' }
  const subject = make(drawn, options)
  const { material } = subject
  const other = make(drawn, options)
  const another = other.material
  await Promise.all([subject.ready, other.ready])
  // Both read the same tables, so that there is nothing to wait for.
  const [method, otherMethod] = options.surface.methods.filter(
    (name) => !['baked', 'taylor'].includes(name),
  )
  const geometry = new SphereGeometry(1, 16, 8)
  const scene = new Scene()
  scene.add(new Mesh(geometry, material))
  const camera = new PerspectiveCamera(50, 1, 0.1, 100)
  camera.position.z = 4
  const sun = new DirectionalLight()
  sun.position.set(0.3, 0, 1)
  scene.add(sun)
  const lamp = new PointLight()
  const second = new Mesh(geometry, material)
  const own = new Mesh(geometry, another)
  const instances = new InstancedMesh(geometry, material, 2)
  instances.setMatrixAt(1, new Matrix4().makeTranslation(1, 0, 0))

  const changes: Record<string, () => void> = {
    start: () => undefined,
    'a light goes dark': () => (sun.intensity = 0),
    'and bright': () => (sun.intensity = 1),
    'is hidden': () => (sun.visible = false),
    'and shown': () => (sun.visible = true),
    'turns red': () => sun.color.set(0xff0000),
    'another red': () => sun.color.set(0xff4400),
    'and white': () => sun.color.set(0xffffff),
    'has a size': () => (sun.userData.angularRadius = 0.02),
    'and none': () => delete sun.userData.angularRadius,
    'a lamp comes': () => scene.add(lamp),
    'and goes': () => scene.remove(lamp),
    'an environment comes': () => (scene.environment = studio),
    'gives way to another': () => (scene.environment = night),
    'and goes again': () => (scene.environment = null),
    'an environment of its own': () => (material.envMap = studio),
    'no longer': () => (material.envMap = null),
    'a rough surface': () => {
      subject.set({ roughness: 0.02 })
    },
    'a sharp one': () => {
      subject.set({ roughness: 0 })
    },
    'another method': () => {
      subject.set({ method: otherMethod! })
    },
    'and the first again': () => {
      subject.set({ method: method! })
    },
    lacquered: () => {
      subject.coat(0.5)
    },
    bare: () => {
      subject.coat(0)
    },
    'an object comes': () => scene.add(second),
    'and one with a material of its own': () => scene.add(own),
    'and instances': () => scene.add(instances),
    'they go': () => scene.remove(second, own, instances),
  }
  const compilations = Object.keys(changes).map((change) => ({ change, first: 0, later: 0 }))
  const programs: number[] = []
  for (let round = 0; round < ROUNDS; round++) {
    for (const [i, change] of Object.values(changes).entries()) {
      linked = 0
      change()
      for (let frame = 0; frame < FRAMES; frame++) renderer.render(scene, camera)
      compilations[i]![round === 0 ? 'first' : 'later'] += linked
    }
    programs.push(renderer.info.programs!.length - programsBefore)
  }
  material.dispose()
  another.dispose()
  studio.dispose()
  night.dispose()
  renderer.dispose()
  renderer.forceContextLoss()
  return { compilations, programs }
}

function make(drawn: Drawn, options: DiffractionMaterialOptions): Diffracting {
  if (drawn === 'DiffractionMaterial') {
    const material = new DiffractionMaterial(options)
    return {
      material,
      ready: material.ready,
      set: (settings) => void Object.assign(material, settings),
      coat: (share) => (material.coat = share),
    }
  }
  const material = new MeshPhysicalMaterial()
  const layer = diffractionLayer(material, options)
  return {
    material,
    ready: layer.ready,
    set: (settings) => {
      layer.set(settings)
    },
    coat: (share) => (material.clearcoat = share),
  }
}

/** three's own materials have it filtered on the GPU, by programs that are not counted. */
function letThreeFilter(environment: Texture, renderer: WebGLRenderer): void {
  const scene = new Scene()
  scene.environment = environment
  const material = new MeshStandardMaterial()
  const geometry = new SphereGeometry()
  scene.add(new Mesh(geometry, material))
  renderer.render(scene, new PerspectiveCamera())
  geometry.dispose()
  material.dispose()
}
