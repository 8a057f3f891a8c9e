import {
  CubeTexture,
  DataTexture,
  FloatType,
  LinearFilter,
  MathUtils,
  Mesh,
  MeshBasicMaterial,
  PlaneGeometry,
  RGBAFormat,
  Vector4,
  WebGLRenderTarget,
  type WebGLRenderer,
} from 'three'
import { buildScene, placeMesh, type BuiltScene } from './build-scene'
import type { MeshDescription, SceneDescription } from './scene-description'

/** What changes before a frame is drawn. */
export interface PlanarStep {
  /** Turns the mesh. */
  rotation_deg?: [number, number, number]
  /** Turns the environment about the vertical, rad. */
  environmentTurn?: number
  roughness?: number
  /** A cube whose faces differ in colour, in the place of the environment. */
  cube?: true
  orientation?: number
  /** Another mesh of the same material and geometry in the picture, or none. */
  companion?: Pick<MeshDescription, 'position' | 'rotation_deg' | 'scale'> | null
}

export interface PlanarFrame {
  /** Whether the table was read, and what the material says of it. */
  included: boolean
  why: string
  /** Likewise of the layers of the blurred environment. */
  blur: { included: boolean; why: string }
  /** Programs that the renderer holds after the frame. */
  programs: number
  /** Calls of `render` within the frame's own: what it took to make the table or the layers. */
  inner: number
  /** Linear sRGB and coverage, rows from the bottom. */
  pixels: number[]
}

/** Draws frames of one scene, one for each step, into a part of a target, with something else drawn after the mesh. */
export async function drawPlanarFrames(
  renderer: WebGLRenderer,
  description: SceneDescription,
  steps: PlanarStep[],
): Promise<PlanarFrame[]> {
  const built = await buildScene(description)
  const target = new WebGLRenderTarget(...description.size, { type: FloatType })
  const square = new Mesh(new PlaneGeometry(0.1, 0.1), new MeshBasicMaterial({ color: 0x336699 }))
  square.renderOrder = 1
  square.position.set(0, 0, 0.2)
  built.scene.add(square)
  target.viewport = new Vector4(2, 1, description.size[0] - 4, description.size[1] - 2)
  target.scissor = new Vector4(3, 2, description.size[0] - 6, description.size[1] - 4)
  target.scissorTest = true
  const companion = new Mesh(built.mesh.geometry, built.mesh.material)
  let inner = 0
  const render = renderer.render.bind(renderer)
  try {
    const frames: PlanarFrame[] = []
    for (const step of steps) {
      take(built, companion, step)
      await built.mesh.material.ready
      renderer.setRenderTarget(target)
      renderer.setClearColor(0x000000, 0)
      inner = -1
      renderer.render = (...args) => {
        inner++
        render(...args)
      }
      renderer.render(built.scene, built.camera)
      const features = built.mesh.material.explain()
      const explained = (name: string): { included: boolean; why: string } =>
        features.find(({ feature }) => feature === name)!
      const table = explained('table of the environment for a flat surface')
      const pixels = new Float32Array(4 * description.size[0] * description.size[1])
      renderer.readRenderTargetPixels(target, 0, 0, ...description.size, pixels)
      frames.push({
        included: table.included,
        why: table.why,
        blur: explained('environment blurred for the roughness'),
        programs: renderer.info.programs!.length,
        inner,
        pixels: Array.from(pixels),
      })
    }
    return frames
  } finally {
    renderer.render = render
    renderer.setRenderTarget(null)
    target.dispose()
    square.geometry.dispose()
    square.material.dispose()
    built.dispose()
  }
}

function take({ scene, mesh }: BuiltScene, companion: Mesh, step: PlanarStep): void {
  if (step.rotation_deg) {
    const [x, y, z] = step.rotation_deg.map(MathUtils.degToRad)
    mesh.rotation.set(x!, y!, z!)
  }
  if (step.environmentTurn !== undefined) scene.environmentRotation.y = step.environmentTurn
  if (step.roughness !== undefined) mesh.material.roughness = step.roughness
  if (step.cube) scene.environment = colouredCube()
  if (step.orientation !== undefined)
    (mesh.material.surface as unknown as { orientation: number }).orientation = step.orientation
  if (step.companion === null) scene.remove(companion)
  else if (step.companion) {
    placeMesh(companion, step.companion as MeshDescription)
    scene.add(companion)
  }
}

const CUBE_TEXELS = 64

function colouredCube(): CubeTexture {
  const faces = [1, 2, 3, 4, 5, 6].map((bits) => {
    const data = new Float32Array(4 * CUBE_TEXELS ** 2)
    for (let i = 0; i < data.length; i += 4)
      data.set([bits & 1 ? 1 : 0.1, bits & 2 ? 1 : 0.1, bits & 4 ? 1 : 0.1, 1], i)
    const face = new DataTexture(data, CUBE_TEXELS, CUBE_TEXELS, RGBAFormat, FloatType)
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
