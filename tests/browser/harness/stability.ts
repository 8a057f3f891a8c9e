import {
  DirectionalLight,
  FloatType,
  Mesh,
  NearestFilter,
  PerspectiveCamera,
  PlaneGeometry,
  PointLight,
  RGBAFormat,
  Scene,
  SphereGeometry,
  SpotLight,
  Vector2,
  WebGLRenderTarget,
  type BufferGeometry,
  type WebGLRenderer,
} from 'three'
import type { DiffractionMaterial } from '../../../web'
import { windowVariance } from '../../../web/spectrum/spectrum-optics'
import { buildMaterial } from './build-scene'
import { harshEnvironment } from './environment'
import type { MaterialDescription, SurfaceDescription } from './scene-description'

/** A surface and a material whose program many sets of parameters share. */
export interface StabilityProgram {
  surface: SurfaceDescription
  material?: MaterialDescription
  /** Linear sRGB of the light: white where left out. */
  color?: [number, number, number]
  /** Directional where left out. */
  light?: 'point' | 'spot'
  /** Texels of an environment with a sun of 1e5 and with what light cannot be; none where left out. */
  environment?: 'float' | 'half'
}

/** What a picture is drawn with beside its program: uniforms, transforms and texture coordinates alone. */
export interface StabilitySet {
  /** Of a grating, µm. */
  period?: number
  /** Of a grating's relief, µm. */
  height?: number
  /** rad */
  orientation: number
  /** Standard deviation of the normal's tilt, rad; above 0 only where the program's is. */
  roughness?: number
  /** σ, µm */
  coherence?: number
  mesh: 'plane' | 'sphere'
  uv: 'given' | 'mirrored' | 'constant'
  scale: [number, number, number]
  /** Scene units of mesh and camera distance. */
  unit: number
  /** To the light, its standard deviation, rad (a point where left out), and how far a point or spot light is, units (1). */
  light: { direction: [number, number, number]; angularRadius?: number; distance?: number }
  /** To the camera, and its distance in units. */
  view: { direction: [number, number, number]; distance: number; fov_deg: number }
}

export interface StabilityResult {
  /** Channels that are no finite number, of all pixels. */
  nonFinite: number
  /** Luminance Y of the darkest and of the brightest pixel that is finite; pixels beside the mesh are 0. */
  least: number
  largest: number
}

/** Odd, so that a pixel's centre lies on the camera's axis: a plane seen edge-on covers no other. */
const SIZE = 15

const LIGHTS = { directional: DirectionalLight, point: PointLight, spot: SpotLight }

/** Y of linear sRGB. */
const LUMINANCE = [0.2126, 0.7152, 0.0722] as const

/** Draws a program with one set after the other, without recompilation between them. */
export async function drawSets(
  renderer: WebGLRenderer,
  program: StabilityProgram,
  sets: StabilitySet[],
): Promise<StabilityResult[]> {
  const { surface, material: options } = program
  const material = await buildMaterial({
    surface,
    ...(options && { material: options }),
    // A negative scale turns the front to the back.
    mesh: { kind: 'plane', size: [2, 2], side: 'double' },
  })
  const scene = new Scene()
  const light = new LIGHTS[program.light ?? 'directional']()
  light.color.setRGB(...(program.color ?? [1, 1, 1]))
  const environment = program.environment ? harshEnvironment(program.environment) : null
  scene.environment = environment
  const mesh = new Mesh<BufferGeometry, DiffractionMaterial>(new PlaneGeometry(2, 2), material)
  scene.add(light, mesh)
  const geometries = new Map<string, BufferGeometry>()
  const target = new WebGLRenderTarget(SIZE, SIZE, {
    type: FloatType,
    format: RGBAFormat,
    minFilter: NearestFilter,
    magFilter: NearestFilter,
  })
  renderer.setRenderTarget(target)
  renderer.setClearColor(0x000000, 0)
  const pixels = new Float32Array(SIZE * SIZE * 4)
  const results = sets.map((set) => {
    const key = `${set.mesh}, ${set.uv}`
    let geometry = geometries.get(key)
    if (geometry === undefined) geometries.set(key, (geometry = geometryOf(set)))
    mesh.geometry = geometry
    mesh.scale.set(...set.scale).multiplyScalar(set.unit)
    light.position.set(...set.light.direction)
    if (program.light !== undefined) {
      const distance = (set.light.distance ?? 1) * set.unit
      light.position.multiplyScalar(distance)
      light.intensity = distance ** 2
    }
    light.userData = { angularRadius: set.light.angularRadius }
    setUniforms(material, set)
    renderer.clear()
    renderer.render(scene, cameraOf(set))
    renderer.readRenderTargetPixels(target, 0, 0, SIZE, SIZE, pixels)
    return examined(pixels)
  })
  renderer.setRenderTarget(null)
  target.dispose()
  material.dispose()
  environment?.dispose()
  for (const geometry of geometries.values()) geometry.dispose()
  return results
}

function setUniforms({ uniforms }: DiffractionMaterial, set: StabilitySet): void {
  const { period, height, roughness, coherence, orientation } = set
  const direction = uniforms.uGratingDirection ?? uniforms.uReliefDirection
  ;(direction?.value as Vector2 | undefined)?.set(Math.cos(orientation), Math.sin(orientation))
  if (period !== undefined) uniforms.uGratingFrequency!.value = 1 / period
  if (height !== undefined) uniforms.uGratingHeight!.value = height
  if (roughness !== undefined) uniforms.uRoughness!.value = roughness
  if (coherence !== undefined) uniforms.uWindowVariance!.value = windowVariance(coherence)
}

function geometryOf({ mesh, uv }: StabilitySet): BufferGeometry {
  const geometry = mesh === 'plane' ? new PlaneGeometry(2, 2) : new SphereGeometry(1, 64, 32)
  const coordinates = geometry.getAttribute('uv')
  if (uv === 'constant') coordinates.array.fill(0.5)
  if (uv === 'mirrored')
    for (let i = 0; i < coordinates.count; i++) coordinates.setX(i, 1 - coordinates.getX(i))
  return geometry
}

function cameraOf({ view, unit }: StabilitySet): PerspectiveCamera {
  const distance = view.distance * unit
  const camera = new PerspectiveCamera(view.fov_deg, 1, 0.01 * distance, 10 * distance)
  camera.position.set(...view.direction).setLength(distance)
  camera.up.set(0.1, 0.2, 1)
  camera.lookAt(0, 0, 0)
  camera.updateMatrixWorld()
  return camera
}

function examined(pixels: Float32Array): StabilityResult {
  const result = { nonFinite: 0, least: Infinity, largest: -Infinity }
  for (let i = 0; i < pixels.length; i += 4) {
    const rgb = pixels.subarray(i, i + 3)
    const bad = rgb.reduce((count, channel) => count + (Number.isFinite(channel) ? 0 : 1), 0)
    result.nonFinite += bad
    if (bad > 0) continue
    const luminance = rgb.reduce((sum, channel, c) => sum + LUMINANCE[c]! * channel, 0)
    result.least = Math.min(result.least, luminance)
    result.largest = Math.max(result.largest, luminance)
  }
  return result
}
