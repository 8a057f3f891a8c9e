import {
  ACESFilmicToneMapping,
  AmbientLight,
  BasicShadowMap,
  BatchedMesh,
  Bone,
  BoxGeometry,
  CubeTexture,
  DataTexture,
  DirectionalLight,
  DoubleSide,
  BackSide,
  Float32BufferAttribute,
  Fog,
  FogExp2,
  HemisphereLight,
  InstancedMesh,
  Matrix4,
  Mesh,
  PCFShadowMap,
  PerspectiveCamera,
  Plane,
  PlaneGeometry,
  PointLight,
  RectAreaLight,
  Scene,
  Skeleton,
  SkinnedMesh,
  SphereGeometry,
  SpotLight,
  Uint16BufferAttribute,
  Vector3,
  VSMShadowMap,
  WebGLRenderer,
  type Object3D,
  type ShadowMapType,
} from 'three'
import { SunLight } from 'three/addons/lights/SunLight.js'
import { DiffractionMaterial, Grating, type DiffractionMaterialOptions } from '../../../web'
import { loadEnvironment } from './environment'

type Prepare = (scene: Scene, renderer: WebGLRenderer) => void | Promise<void>

interface Variant {
  options?: Partial<DiffractionMaterialOptions>
  object?: (material: DiffractionMaterial) => Object3D
  prepare?: Prepare
  logarithmicDepthBuffer?: boolean
}

/** Every way in which three can ask something else of the shader. */
const VARIANTS: Record<string, Variant> = {
  plain: {},
  instancing: { object: instanced },
  batching: { object: batched },
  skinning: { object: skinned },
  'morph targets': { object: morphed },
  'vertex colours': { options: { vertexColors: true }, object: coloured },
  'flat shading': { options: { flatShading: true } },
  'back side': { options: { side: BackSide } },
  'double side': { options: { side: DoubleSide } },
  transparent: { options: { transparent: true, opacity: 0.5, premultipliedAlpha: true } },
  dithering: { options: { dithering: true } },
  tangents: { object: (material) => new Mesh(withTangents(), material) },
  'normal map': { options: { normalMap: texture(128, 128, 255) } },
  'normal map and tangents': {
    options: { normalMap: texture(128, 128, 255) },
    object: (material) => new Mesh(withTangents(), material),
  },
  'bump map': { options: { bumpMap: texture(128, 128, 128) } },
  'base map': {
    options: { map: texture(255, 128, 0), surface: grating({ strength: 0.5 }) },
  },
  'circular tracks': { options: { surface: grating({ tracks: 'circular' }) } },
  lacquer: { options: { coat: 1, coatRoughness: 0.2 } },
  'without diffraction': { options: { diffraction: false, coat: 0.5 } },
  'wavelength loop': { options: { method: 'wavelength-loop', wavelengthStep: 0.02 } },
  'Taylor efficiencies': {
    options: { method: 'wavelength-loop', wavelengthStep: 0.02, efficiencies: 'taylor' },
  },
  kirchhoff: { options: { energy: 'kirchhoff' } },
  reciprocal: { options: { energy: 'reciprocal' } },
  'tone mapping': {
    prepare: (_scene, renderer) => void (renderer.toneMapping = ACESFilmicToneMapping),
  },
  fog: { prepare: (scene) => void (scene.fog = new Fog(0xff0000, 1, 10)) },
  'exponential fog': { prepare: (scene) => void (scene.fog = new FogExp2(0xff0000, 0.1)) },
  'clipping planes': {
    options: { clippingPlanes: [new Plane(new Vector3(1, 0, 0), 0)] },
    prepare: (_scene, renderer) => void (renderer.localClippingEnabled = true),
  },
  'logarithmic depth': { logarithmicDepthBuffer: true },
  'basic shadows': { prepare: shadows(BasicShadowMap) },
  'filtered shadows': { prepare: shadows(PCFShadowMap) },
  'variance shadows': { prepare: shadows(VSMShadowMap) },
  'spot light map': { prepare: spotLightMap },
  'ambient, hemisphere and area lights': {
    options: { surface: grating({ strength: 0.5 }) },
    prepare: (scene) => {
      scene.add(new AmbientLight(), new HemisphereLight(), new RectAreaLight())
    },
  },
  'equirectangular environment': {
    options: { coat: 1, surface: grating({ strength: 0.5 }) },
    prepare: async (scene) => {
      scene.environment = await loadEnvironment({ constant: [1, 1, 1] })
    },
  },
  'cube environment': {
    prepare: (scene) => {
      scene.environment = cube()
    },
  },
}

/** Draws every variant once; returns what went wrong, by the variant's name. */
export async function drawVariants(): Promise<Record<string, string>> {
  const failures: Record<string, string> = {}
  for (const [name, variant] of Object.entries(VARIANTS))
    try {
      await draw(variant)
    } catch (error) {
      failures[name] = String(error)
    }
  return failures
}

async function draw(variant: Variant): Promise<void> {
  const renderer = new WebGLRenderer({
    logarithmicDepthBuffer: variant.logarithmicDepthBuffer ?? false,
  })
  renderer.setSize(32, 32)
  renderer.debug.onShaderError = (gl, program, vertex, fragment) => {
    const logs = [
      gl.getProgramInfoLog(program),
      gl.getShaderInfoLog(vertex),
      gl.getShaderInfoLog(fragment),
    ]
    throw new Error(logs.join('\n'))
  }
  const material = new DiffractionMaterial({
    surface: grating({}),
    mapsPath: '/maps/baked/',
    ...variant.options,
  })
  await material.ready
  const scene = new Scene()
  scene.add(new DirectionalLight(), new PointLight(), new SpotLight(0xffffff, 1, 0, 0.5))
  for (const [i, light] of scene.children.entries()) light.position.set(i - 1, 1, 2)
  const object = variant.object?.(material) ?? new Mesh(new SphereGeometry(1), material)
  object.receiveShadow = true
  object.castShadow = true
  scene.add(object)
  const camera = new PerspectiveCamera(50, 1, 0.1, 100)
  camera.position.z = 3
  await variant.prepare?.(scene, renderer)
  renderer.render(scene, camera)
  const gl = renderer.getContext()
  const code = gl.getError()
  if (code !== gl.NO_ERROR) throw new Error(`WebGL error ${code}`)
  material.dispose()
  renderer.dispose()
  renderer.forceContextLoss()
}

function grating(options: { strength?: number; tracks?: 'straight' | 'circular' }): Grating {
  return new Grating({ period: 1.6, height: 0.1, ...options })
}

function texture(r: number, g: number, b: number): DataTexture {
  const made = new DataTexture(new Uint8Array([r, g, b, 255]), 1, 1)
  made.needsUpdate = true
  return made
}

function cube(): CubeTexture {
  const made = new CubeTexture(
    Array.from({ length: 6 }, () => {
      const canvas = document.createElement('canvas')
      canvas.width = canvas.height = 8
      return canvas
    }),
  )
  made.needsUpdate = true
  return made
}

function withTangents(): SphereGeometry {
  const geometry = new SphereGeometry(1)
  geometry.computeTangents()
  return geometry
}

function instanced(material: DiffractionMaterial): Object3D {
  const mesh = new InstancedMesh(withTangents(), material, 2)
  mesh.setMatrixAt(0, new Matrix4().makeScale(-0.5, 0.5, 0.5))
  mesh.setMatrixAt(1, new Matrix4().makeTranslation(1, 0, 0))
  return mesh
}

function batched(material: DiffractionMaterial): Object3D {
  const mesh = new BatchedMesh(2, 2000, 6000, material)
  const id = mesh.addGeometry(new BoxGeometry())
  mesh.addInstance(id)
  mesh.addInstance(id)
  return mesh
}

function skinned(material: DiffractionMaterial): Object3D {
  const geometry = new SphereGeometry(1)
  const { count } = geometry.getAttribute('position')
  geometry.setAttribute('skinIndex', new Uint16BufferAttribute(new Uint16Array(4 * count), 4))
  const weights = Float32Array.from({ length: 4 * count }, (_, i) => (i % 4 === 0 ? 1 : 0))
  geometry.setAttribute('skinWeight', new Float32BufferAttribute(weights, 4))
  const mesh = new SkinnedMesh(geometry, material)
  const bone = new Bone()
  mesh.add(bone)
  mesh.bind(new Skeleton([bone]))
  return mesh
}

function morphed(material: DiffractionMaterial): Object3D {
  const geometry = new SphereGeometry(1)
  geometry.morphAttributes.position = [geometry.getAttribute('position').clone()]
  geometry.morphAttributes.normal = [geometry.getAttribute('normal').clone()]
  const mesh = new Mesh(geometry, material)
  mesh.morphTargetInfluences = [0.5]
  return mesh
}

function coloured(material: DiffractionMaterial): Object3D {
  const geometry = new SphereGeometry(1)
  const { count } = geometry.getAttribute('position')
  geometry.setAttribute(
    'color',
    new Float32BufferAttribute(new Float32Array(3 * count).fill(0.5), 3),
  )
  return new Mesh(geometry, material)
}

function shadows(type: ShadowMapType): Prepare {
  return (scene, renderer) => {
    renderer.shadowMap.enabled = true
    renderer.shadowMap.type = type
    const sun = new SunLight()
    scene.add(sun)
    // three has no variance shadows for point lights.
    for (const light of scene.children)
      light.castShadow = !(type === VSMShadowMap && light instanceof PointLight)
    const floor = new Mesh(
      new PlaneGeometry(4, 4),
      new DiffractionMaterial({
        surface: grating({}),
        mapsPath: '/maps/baked/',
      }),
    )
    floor.receiveShadow = true
    floor.position.z = -1
    scene.add(floor)
  }
}

function spotLightMap(scene: Scene): void {
  const light = new SpotLight()
  light.position.z = 3
  light.castShadow = true
  light.map = texture(255, 0, 0)
  scene.add(light)
}
