/** What the pages take for granted: the names that a block may ask for by `given=`, as they are in a reader's program. */
import {
  DataTexture,
  DirectionalLight,
  EquirectangularReflectionMapping,
  FloatType,
  Mesh,
  MeshPhysicalMaterial,
  PerspectiveCamera,
  PlaneGeometry,
  Scene,
  WebGLRenderer,
} from 'three'
import { OrbitControls } from 'three/addons/controls/OrbitControls.js'
import { DiffractionMaterial, Foil, Grating, type DiffractionError } from 'three-diffraction'

export const renderer = new WebGLRenderer()
renderer.setSize(64, 64)
document.body.append(renderer.domElement)

export const camera = new PerspectiveCamera(40, 1, 0.1, 10)
camera.position.z = 3
export const controls = new OrbitControls(camera, renderer.domElement)

/** As an HDR file is loaded: 8 × 4 texels, grey, with one lamp. */
export const hdr = new DataTexture(new Float32Array(4 * 32).fill(0.5), 8, 4)
hdr.type = FloatType
hdr.mapping = EquirectangularReflectionMapping
hdr.image.data!.fill(50, 40, 44)
hdr.needsUpdate = true

export const light = new DirectionalLight(0xffffff, 1)
// As glTF has it.
light.target.position.z = -1
light.add(light.target)
export const paper = new MeshPhysicalMaterial({ roughness: 0.7 })
export const surface = new Grating({ period: 1.6, height: 0.12 })
export const foil = await Foil.load('maps/baked/foil-polygons')
export const material = new DiffractionMaterial({ surface })

export const scene = new Scene()
for (const [i, shown] of [paper, material].entries()) {
  const mesh = new Mesh(new PlaneGeometry(), shown)
  mesh.position.x = i - 0.5
  scene.add(mesh)
}
scene.add(light)

export const report = (error: DiffractionError): never => {
  throw error
}
