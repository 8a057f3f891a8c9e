import {
  Bone,
  BoxGeometry,
  CubeTexture,
  DataTexture,
  DirectionalLight,
  Float32BufferAttribute,
  FloatType,
  Fog,
  InstancedMesh,
  LinearFilter,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  OrthographicCamera,
  Plane,
  PlaneGeometry,
  RGBAFormat,
  Scene,
  Skeleton,
  SkinnedMesh,
  Vector3,
  Uint16BufferAttribute,
  WebGLRenderer,
  WebGLRenderTarget,
  type BufferGeometry,
  type Material,
  type MaterialParameters,
  type Object3D,
} from 'three'
import {
  diffractionLayer,
  DiffractionMaterial,
  Grating,
  type DiffractionMaterialOptions,
} from '../../../web'
import { loadEnvironment } from './environment'

/** Linear colour of the picture's middle. */
type Pixel = [number, number, number]

/** What draws the grating. */
export type Drawn = 'DiffractionMaterial' | 'diffractionLayer'

interface Probe {
  options?: MaterialParameters & Pick<DiffractionMaterialOptions, 'normalMap' | 'flatShading'>
  object?: (material: Material) => Object3D
  prepare?: (scene: Scene, renderer: WebGLRenderer, light: DirectionalLight) => void | Promise<void>
}

const PROBES = {
  plain: {},
  'in shadow': { prepare: shadedBy(1) },
  'beside a shadow': { prepare: shadedBy(-1) },
  'deep in fog': { prepare: (scene: Scene) => void (scene.fog = new Fog(0x336699, 0.1, 0.2)) },
  'clipped away': {
    options: { clippingPlanes: [new Plane(new Vector3(0, 0, -1), -0.5)] },
    prepare: (_: Scene, renderer: WebGLRenderer) => void (renderer.localClippingEnabled = true),
  },
  'as an instance': {
    object: (material: Material) => {
      const mesh = new InstancedMesh(plane(), material, 1)
      mesh.setMatrixAt(0, new Matrix4())
      return mesh
    },
  },
  'tilted by a third': { object: (material: Material) => new Mesh(tiltedPlane(), material) },
  'turned back by a bone': { object: skinnedBack },
  'turned back by a morph target': { object: morphedBack },
  'flat shading': { options: { flatShading: true }, object: wronglyShaded },
  'flat normal map': { options: { normalMap: texel(127.5, 127.5, 255) } },
  'tilted normal map': { options: { normalMap: texel(200, 127.5, 230) } },
  'white equirectangular environment': {
    prepare: async (scene: Scene, _: WebGLRenderer, light: DirectionalLight) => {
      light.visible = false
      scene.environment = await loadEnvironment({ constant: [1, 1, 1] })
    },
  },
  'white cube environment': {
    prepare: (scene: Scene, _: WebGLRenderer, light: DirectionalLight) => {
      light.visible = false
      scene.environment = whiteCube()
    },
  },
} satisfies Record<string, Probe>

export type ProbeName = keyof typeof PROBES

/** A grating under one light that its first order sends to the viewer, seen with each of three's features in turn. */
export async function probeFeatures(drawn: Drawn): Promise<Record<ProbeName, Pixel>> {
  const names = Object.keys(PROBES) as ProbeName[]
  const pixels: Partial<Record<ProbeName, Pixel>> = {}
  for (const name of names) pixels[name] = await probe(drawn, PROBES[name])
  return pixels as Record<ProbeName, Pixel>
}

async function probe(drawn: Drawn, { options, object, prepare }: Probe): Promise<Pixel> {
  const renderer = new WebGLRenderer()
  const material = await makeMaterial(drawn, options)
  const scene = new Scene()
  const light = new DirectionalLight(0xffffff, 1)
  // u = 0.55 = λ/a for green light and the viewer on the normal.
  light.position.set(0.55, 0, Math.sqrt(1 - 0.55 ** 2)).multiplyScalar(5)
  const surface = object?.(material) ?? new Mesh(plane(), material)
  surface.receiveShadow = true
  scene.add(light, light.target, surface)
  const camera = new OrthographicCamera(-0.1, 0.1, 0.1, -0.1, 0.1, 10)
  camera.position.z = 4
  await prepare?.(scene, renderer, light)
  const target = new WebGLRenderTarget(9, 9, { type: FloatType, format: RGBAFormat })
  renderer.setRenderTarget(target)
  renderer.render(scene, camera)
  const rgba = new Float32Array(4)
  renderer.readRenderTargetPixels(target, 4, 4, 1, 1, rgba)
  target.dispose()
  material.dispose()
  renderer.dispose()
  renderer.forceContextLoss()
  return [rgba[0]!, rgba[1]!, rgba[2]!]
}

async function makeMaterial(drawn: Drawn, options: Probe['options']): Promise<Material> {
  const optics = {
    surface: new Grating({ period: 1, height: 0.1 }),
    mapsPath: '/maps/baked/',
    gamut: 'signed',
  } as const
  if (drawn === 'DiffractionMaterial') {
    const material = new DiffractionMaterial({ ...optics, ...options })
    await material.ready
    return material
  }
  const material = new MeshStandardMaterial(options)
  await diffractionLayer(material, optics).ready
  return material
}

function plane(): PlaneGeometry {
  return new PlaneGeometry(2, 2)
}

const TILT = 1 / 3

function tiltedPlane(): BufferGeometry {
  return plane().rotateY(TILT)
}

/** A plane with the normals of a tilted one. */
function wronglyShaded(material: Material): Mesh {
  const geometry = plane().setAttribute('normal', tiltedPlane().getAttribute('normal'))
  return new Mesh(geometry, material)
}

function skinnedBack(material: Material): SkinnedMesh {
  const geometry = tiltedPlane()
  geometry.setAttribute('skinIndex', new Uint16BufferAttribute(new Uint16Array(16), 4))
  const weights = Array.from({ length: 4 }, () => [1, 0, 0, 0]).flat()
  geometry.setAttribute('skinWeight', new Float32BufferAttribute(weights, 4))
  const mesh = new SkinnedMesh(geometry, material)
  const bone = new Bone()
  mesh.add(bone)
  mesh.bind(new Skeleton([bone]))
  bone.rotation.y = -TILT
  return mesh
}

function morphedBack(material: Material): Mesh {
  const geometry = tiltedPlane()
  const { position, normal } = plane().attributes
  Object.assign(geometry.morphAttributes, { position: [position], normal: [normal] })
  const mesh = new Mesh(geometry, material)
  mesh.morphTargetInfluences = [1]
  return mesh
}

/** A box on the way from the light to the middle (side 1), or on the other side of it (−1). */
function shadedBy(side: number): Probe['prepare'] {
  return (scene, renderer, light) => {
    renderer.shadowMap.enabled = true
    light.castShadow = true
    const box = new Mesh(new BoxGeometry(0.5, 0.5, 0.5), new MeshBasicMaterial())
    box.castShadow = true
    box.position.copy(light.position).setLength(1.5)
    box.position.x *= side
    scene.add(box)
  }
}

function texel(...rgb: [number, number, number]): DataTexture {
  const texture = new DataTexture(
    Float32Array.from([...rgb.map((channel) => channel / 255), 1]),
    1,
    1,
    RGBAFormat,
    FloatType,
  )
  texture.needsUpdate = true
  return texture
}

function whiteCube(): CubeTexture {
  const faces = Array.from({ length: 6 }, () => {
    const face = new DataTexture(new Float32Array(4 * 4 * 4).fill(1), 4, 4, RGBAFormat, FloatType)
    face.needsUpdate = true
    return face
  })
  const cube = new CubeTexture(faces as unknown as HTMLImageElement[])
  cube.format = RGBAFormat
  cube.type = FloatType
  cube.minFilter = cube.magFilter = LinearFilter
  cube.needsUpdate = true
  return cube
}
