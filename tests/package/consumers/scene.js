import {
  CircleGeometry,
  Color,
  DataTexture,
  DirectionalLight,
  EquirectangularReflectionMapping,
  FloatType,
  Mesh,
  PerspectiveCamera,
  PlaneGeometry,
  RGBAFormat,
  Scene,
  WebGLRenderer,
} from 'three'
import { DiffractionMaterial, Foil, Grating, HeightField } from 'three-diffraction'

/** @satisfies {import('three-diffraction').GratingOptions} */
export const disc = {
  period: 1.6,
  height: 0.12,
  profile: 'rectangular',
  tracks: /** @type {const} */ ('circular'),
}

/** @satisfies {import('three-diffraction').HeightFieldOptions} */
export const skin = { field: 'bumps', ior: 1.5 }

/**
 * Arguments of a DataTexture: a dark sky with a bright window.
 *
 * @returns {ConstructorParameters<typeof DataTexture>}
 */
export function sky() {
  const [width, height] = [32, 16]
  const texels = new Float32Array(4 * width * height)
  for (let i = 0; i < width * height; i++) {
    const [column, row] = [i % width, Math.floor(i / width)]
    const radiance = column > 20 && column < 26 && row > 8 && row < 12 ? 1.5 : 0.05
    texels.set([radiance, radiance, radiance, 1], 4 * i)
  }
  return [texels, width, height, RGBAFormat, FloatType, EquirectangularReflectionMapping]
}

/**
 * Draws a disc with circular tracks, a card of foil and a strip of skin.
 *
 * @param {string} maps folder of the package's maps, with its slash
 */
export async function drawScene(maps) {
  // Kept for those who read the picture back.
  const renderer = new WebGLRenderer({ antialias: false, preserveDrawingBuffer: true })
  renderer.setSize(160, 100)
  document.body.append(renderer.domElement)
  const scene = new Scene()
  scene.background = new Color(0x101010)
  scene.environment = new DataTexture(...sky())
  scene.environment.needsUpdate = true
  const camera = new PerspectiveCamera(40, 1.6, 0.1, 10)
  camera.position.z = 3

  const sun = new DirectionalLight(0xffffff, 0.3)
  sun.position.set(0.2, 0.5, 1)
  sun.userData.angularRadius = 0.02
  scene.add(sun)

  const grating = new DiffractionMaterial({ surface: new Grating(disc), mapsPath: maps })
  const left = new Mesh(new CircleGeometry(0.75, 64), grating)
  left.position.x = -0.8
  scene.add(left)

  const foil = await Foil.load(`${maps}foil-polygons`)
  const metal = new DiffractionMaterial({
    surface: foil,
    metal: 'gold',
    roughness: 0.01,
    mapsPath: maps,
  })
  const right = new Mesh(new PlaneGeometry(1.4, 1.4), metal)
  right.position.x = 0.8
  scene.add(right)

  const relief = new DiffractionMaterial({ surface: new HeightField(skin), mapsPath: maps })
  const above = new Mesh(new PlaneGeometry(2.6, 0.2), relief)
  above.position.y = 0.92
  scene.add(above)

  await Promise.all([grating.ready, metal.ready, relief.ready])
  renderer.render(scene, camera)
  document.title = 'drawn'
}
