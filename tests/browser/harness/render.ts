import {
  FloatType,
  NearestFilter,
  RGBAFormat,
  Vector3,
  WebGLRenderTarget,
  type Camera,
  type WebGLRenderer,
} from 'three'
import { fragmentShaderOf, tablesOf, type TableSize } from './program'
import { buildScene, type BuiltScene } from './build-scene'
import { environmentTexels } from './environment'
import { GeometryMaterial } from './geometry-material'
import {
  ProgressiveRefinement,
  type Feature,
  type ProgressiveRefinementOptions,
} from '../../../web'
import type { SceneDescription } from './scene-description'

/** Number of geometry layers, in the order of geometry.frag.glsl. */
export const GEOMETRY_LAYERS = ['position', 'normal', 'tangent', 'grating', 'uv'] as const

export interface RenderedScene {
  width: number
  height: number
  /** Linear sRGB and coverage, rows from top to bottom. */
  radiance: Float32Array
  /** The layers of {@link GEOMETRY_LAYERS}, one after the other, each as `radiance`. */
  geometry: Float32Array
  environment: { width: number; height: number; data: Float32Array } | null
  /** Camera and lights as the shader has them: view space. */
  view: Record<string, unknown>
  /** The fragment shader as WebGL compiled it. */
  fragmentShader: string
  /** What the material says of itself. */
  explanation: Feature[]
  /** The tables that it reads. */
  tables: TableSize[]
}

/** Renders a description to numbers: no tone mapping, no gamut mapping, no 8 bits. */
export async function renderScene(
  renderer: WebGLRenderer,
  description: SceneDescription,
): Promise<RenderedScene> {
  const built = await buildScene(description)
  try {
    const [width, height] = description.size
    const radiance =
      description.refinement === undefined
        ? renderTo(renderer, built, width, height, 1)
        : renderRefined(renderer, built, width, height, description.refinement)
    const material = built.mesh.material
    const shader = {
      fragmentShader: fragmentShaderOf(renderer, material),
      tables: tablesOf(renderer, material),
      explanation: material.explain(),
    }
    const geometryMaterial = new GeometryMaterial(material)
    Object.assign(built.mesh, { material: geometryMaterial })
    const geometry = renderTo(renderer, built, width, height, GEOMETRY_LAYERS.length)
    geometryMaterial.dispose()
    Object.assign(built.mesh, { material })
    return {
      width,
      height,
      radiance,
      geometry,
      environment: built.environment && environmentTexels(built.environment),
      view: describeView(built),
      ...shader,
    }
  } finally {
    built.dispose()
  }
}

export function renderTo(
  renderer: WebGLRenderer,
  { scene, camera }: BuiltScene,
  width: number,
  height: number,
  count: number,
): Float32Array {
  const target = new WebGLRenderTarget(width, height, {
    count,
    type: FloatType,
    format: RGBAFormat,
    minFilter: NearestFilter,
    magFilter: NearestFilter,
  })
  renderer.setRenderTarget(target)
  renderer.setClearColor(0x000000, 0)
  renderer.clear()
  renderer.render(scene, camera)
  const layer = width * height * 4
  const pixels = new Float32Array(count * layer)
  for (let i = 0; i < count; i++) {
    const rows = new Float32Array(layer)
    renderer.readRenderTargetPixels(target, 0, 0, width, height, rows, undefined, i)
    flipRows(rows, width, pixels.subarray(i * layer, (i + 1) * layer))
  }
  renderer.setRenderTarget(null)
  target.dispose()
  return pixels
}

function renderRefined(
  renderer: WebGLRenderer,
  { scene, camera }: BuiltScene,
  width: number,
  height: number,
  options: ProgressiveRefinementOptions,
): Float32Array {
  const refinement = new ProgressiveRefinement(renderer, options)
  renderer.setClearColor(0x000000, 0)
  refinement.begin(width, height)
  while (refinement.frame(scene, camera));
  const rows = new Float32Array(width * height * 4)
  const pixels = new Float32Array(width * height * 4)
  renderer.readRenderTargetPixels(refinement.mean, 0, 0, width, height, rows)
  refinement.dispose()
  flipRows(rows, width, pixels)
  return pixels
}

/** WebGL reads from the bottom up, files go from the top down. */
function flipRows(source: Float32Array, width: number, target: Float32Array): void {
  const stride = 4 * width
  const rows = source.length / stride
  for (let row = 0; row < rows; row++)
    target.set(source.subarray(row * stride, (row + 1) * stride), (rows - 1 - row) * stride)
}

function describeView({ scene, camera, lights }: BuiltScene): Record<string, unknown> {
  return {
    viewMatrix: camera.matrixWorldInverse.toArray(),
    projectionMatrix: camera.projectionMatrix.toArray(),
    environmentIntensity: scene.environmentIntensity,
    environmentRotation: scene.environmentRotation.toArray().slice(0, 3),
    lights: lights.map(({ description, light }) => ({
      kind: description.kind,
      color: light.color.toArray().map((channel) => channel * light.intensity),
      angularRadius: description.angularRadius ?? null,
      ...(description.kind === 'directional'
        ? { direction: directionInView(light.position, camera) }
        : { position: light.position.clone().applyMatrix4(camera.matrixWorldInverse).toArray() }),
    })),
  }
}

function directionInView(direction: Vector3, camera: Camera): number[] {
  return direction.clone().transformDirection(camera.matrixWorldInverse).toArray()
}
