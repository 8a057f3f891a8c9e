import {
  BoxGeometry,
  CubeTexture,
  DataTexture,
  DirectionalLight,
  FloatType,
  Fog,
  InstancedMesh,
  LinearFilter,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  OrthographicCamera,
  Plane,
  PlaneGeometry,
  RGBAFormat,
  Scene,
  Vector3,
  WebGLRenderer,
  WebGLRenderTarget,
  type Object3D,
} from 'three'
import { DiffractionMaterial, Grating, type DiffractionMaterialOptions } from '../../../web'
import { loadEnvironment } from './environment'

/** Linear colour of the picture's middle. */
type Pixel = [number, number, number]

interface Probe {
  options?: Partial<DiffractionMaterialOptions>
  object?: (material: DiffractionMaterial) => Object3D
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
    object: (material: DiffractionMaterial) => {
      const mesh = new InstancedMesh(plane(), material, 1)
      mesh.setMatrixAt(0, new Matrix4())
      return mesh
    },
  },
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
export async function probeFeatures(): Promise<Record<ProbeName, Pixel>> {
  const names = Object.keys(PROBES) as ProbeName[]
  const pixels: Partial<Record<ProbeName, Pixel>> = {}
  for (const name of names) pixels[name] = await probe(PROBES[name])
  return pixels as Record<ProbeName, Pixel>
}

async function probe({ options, object, prepare }: Probe): Promise<Pixel> {
  const renderer = new WebGLRenderer()
  const material = new DiffractionMaterial({
    surface: new Grating({ period: 1, height: 0.1 }),
    mapsPath: '/maps/baked/',
    gamut: 'signed',
    ...options,
  })
  await material.ready
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

function plane(): PlaneGeometry {
  return new PlaneGeometry(2, 2)
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
