import {
  BackSide,
  Color,
  CircleGeometry,
  DirectionalLight,
  DoubleSide,
  Euler,
  FrontSide,
  LatheGeometry,
  MathUtils,
  Mesh,
  PerspectiveCamera,
  PlaneGeometry,
  PointLight,
  RingGeometry,
  Scene,
  SphereGeometry,
  SplineCurve,
  SpotLight,
  Vector2,
  Vector3,
  type BufferGeometry,
  type DataTexture,
  type Light,
} from 'three'
import { DiffractionMaterial, Foil, Grating, HeightField, type Surface } from '../../../web'
import { loadEnvironment } from './environment'
import { force } from './force'
import type {
  LightDescription,
  MeshDescription,
  SceneDescription,
  SurfaceDescription,
} from './scene-description'

export interface BuiltScene {
  scene: Scene
  camera: PerspectiveCamera
  mesh: Mesh<BufferGeometry, DiffractionMaterial>
  lights: { description: LightDescription; light: DirectionalLight | PointLight | SpotLight }[]
  environment: DataTexture | null
  dispose: () => void
}

/** Builds what a description says, and waits until every table is there. */
export async function buildScene(description: SceneDescription): Promise<BuiltScene> {
  const scene = new Scene()
  const environment = description.environment
    ? await loadEnvironment(description.environment)
    : null
  if (environment !== null) {
    const { intensity = 1, rotation_deg = [0, 0, 0] } = description.environment!
    scene.environment = environment
    scene.environmentIntensity = intensity
    scene.environmentRotation = eulerOf(rotation_deg)
  }
  const lights = (description.lights ?? []).map((light) => ({
    description: light,
    light: buildLight(light),
  }))
  for (const { light } of lights) {
    scene.add(light)
    if ('target' in light) scene.add(light.target)
  }
  const mesh = new Mesh(buildGeometry(description.mesh), await buildMaterial(description))
  placeMesh(mesh, description.mesh)
  scene.add(mesh)
  if (description.force !== undefined) await force(scene, mesh.material, description.force)

  const camera = buildCamera(description)
  scene.updateMatrixWorld()
  return {
    scene,
    camera,
    mesh,
    lights,
    environment,
    dispose: () => {
      mesh.geometry.dispose()
      mesh.material.dispose()
      environment?.dispose()
    },
  }
}

export async function buildSurface(description: SurfaceDescription): Promise<Surface> {
  if (description.kind === 'grating') return new Grating(description)
  if (description.kind === 'height-field') return new HeightField(description)
  const { map, repeat, height, filtered } = description
  return Foil.load(map, {
    ...(repeat && { repeat: new Vector2(...repeat) }),
    ...(height !== undefined && { height }),
    ...(filtered !== undefined && { filtered }),
  })
}

export async function buildMaterial(
  description: Pick<SceneDescription, 'material' | 'mesh' | 'surface'>,
): Promise<DiffractionMaterial> {
  const { color, ...options } = description.material ?? {}
  const { side = 'front' } = description.mesh
  const material = new DiffractionMaterial({
    gamut: 'signed',
    mapsPath: '/maps/baked/',
    ...options,
    ...(color && { color: new Color(...color) }),
    side: { front: FrontSide, back: BackSide, double: DoubleSide }[side],
    surface: await buildSurface(description.surface),
  })
  await material.ready
  return material
}

export function buildGeometry(description: MeshDescription): BufferGeometry {
  const geometry = shapeOf(description)
  if (description.constantUv) geometry.getAttribute('uv').array.fill(0.5)
  if (description.tangents) geometry.computeTangents()
  return geometry
}

export function placeMesh(mesh: Mesh, { position, rotation_deg, scale }: MeshDescription): void {
  mesh.position.set(...(position ?? [0, 0, 0]))
  mesh.rotation.copy(eulerOf(rotation_deg ?? [0, 0, 0]))
  mesh.scale.set(...(scale ?? [1, 1, 1]))
}

function shapeOf(description: MeshDescription): BufferGeometry {
  switch (description.kind) {
    case 'plane':
      return new PlaneGeometry(...description.size)
    case 'sphere':
      return new SphereGeometry(description.radius, 256, 128)
    case 'disc':
      return description.inner > 0
        ? new RingGeometry(description.inner, description.outer, 256)
        : new CircleGeometry(description.outer, 256)
    case 'lathe': {
      const outline = new SplineCurve(description.outline.map((point) => new Vector2(...point)))
      return new LatheGeometry(outline.getPoints(128), 256)
    }
  }
}

export function buildCamera({ camera, size }: SceneDescription): PerspectiveCamera {
  const built = new PerspectiveCamera(camera.fov_deg, size[0] / size[1], 0.01, 1000)
  built.position.set(...camera.position)
  built.up.set(...(camera.up ?? [0, 1, 0]))
  built.lookAt(new Vector3(...(camera.target ?? [0, 0, 0])))
  built.updateMatrixWorld()
  return built
}

export function buildLight(
  description: LightDescription,
): DirectionalLight | PointLight | SpotLight {
  const light = bareLight(description)
  light.color.setRGB(...(description.color ?? [1, 1, 1]))
  light.intensity = description.intensity ?? 1
  if (description.angularRadius !== undefined)
    (light as Light).userData.angularRadius = description.angularRadius
  return light
}

function bareLight(description: LightDescription): DirectionalLight | PointLight | SpotLight {
  switch (description.kind) {
    case 'directional': {
      const light = new DirectionalLight()
      light.position.set(...description.direction)
      return light
    }
    case 'point': {
      const light = new PointLight()
      light.position.set(...description.position)
      light.decay = description.decay ?? 2
      light.distance = description.distance ?? 0
      return light
    }
    case 'spot': {
      const light = new SpotLight()
      light.position.set(...description.position)
      light.target.position.set(...(description.target ?? [0, 0, 0]))
      light.decay = description.decay ?? 2
      light.distance = description.distance ?? 0
      light.angle = MathUtils.degToRad(description.angle_deg)
      light.penumbra = description.penumbra ?? 0
      return light
    }
  }
}

function eulerOf([x, y, z]: [number, number, number]): Euler {
  return new Euler(MathUtils.degToRad(x), MathUtils.degToRad(y), MathUtils.degToRad(z))
}
