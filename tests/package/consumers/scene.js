import {
  DataTexture,
  DirectionalLight,
  EquirectangularReflectionMapping,
  FloatType,
  Mesh,
  PerspectiveCamera,
  PlaneGeometry,
  RingGeometry,
  Scene,
  WebGLRenderer,
} from 'three'
import { DiffractionMaterial, Foil, Grating } from 'three-diffraction'

/**
 * A disc and a foil card under a light and a grey sky with a white half, as every consumer draws them.
 *
 * @param {string} mapsPath
 */
async function draw(mapsPath) {
  const renderer = new WebGLRenderer({ preserveDrawingBuffer: true })
  renderer.setSize(96, 64)
  document.body.append(renderer.domElement)
  const scene = new Scene()
  const sky = new Float32Array(8 * 4 * 4).map((_, i) => (i % 32 < 16 ? 1 : 0.3))
  scene.environment = new DataTexture(sky, 8, 4, undefined, FloatType)
  scene.environment.mapping = EquirectangularReflectionMapping
  scene.environment.needsUpdate = true
  const light = new DirectionalLight(0xffffff, 2)
  light.position.set(0.35, 0.2, 1)
  scene.add(light)
  const disc = new DiffractionMaterial({
    surface: new Grating({ period: 1.6, height: 0.12, profile: 'rectangular', tracks: 'circular' }),
    mapsPath,
  })
  const card = new DiffractionMaterial({
    surface: await Foil.load(`${mapsPath}foil-polygons`),
    roughness: 0.01,
    maxError: 0.01,
    mapsPath,
  })
  await Promise.all([disc.ready, card.ready])
  const left = new Mesh(new RingGeometry(0.3, 0.9, 48), disc)
  const right = new Mesh(new PlaneGeometry(1.6, 1.6), card)
  left.position.x = -1
  right.position.x = 1
  scene.add(left, right)
  const camera = new PerspectiveCamera(40, 1.5, 0.1, 10)
  camera.position.z = 3
  for (let frame = 0; frame < 4; frame++) renderer.render(scene, camera)
  const gl = renderer.getContext()
  const pixels = new Uint8Array(4 * 96 * 64)
  gl.readPixels(0, 0, 96, 64, gl.RGBA, gl.UNSIGNED_BYTE, pixels)
  const features = card.explain().filter(({ included }) => included)
  return { pixels: Array.from(pixels), features: features.map(({ feature }) => feature) }
}

Object.assign(window, { drawn: draw('/maps/').catch((error) => ({ error: String(error) })) })
