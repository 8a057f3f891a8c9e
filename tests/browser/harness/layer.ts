import { Color, MeshPhysicalMaterial, MeshStandardMaterial, type WebGLRenderer } from 'three'
import {
  diffractionLayer,
  type DiffractionLayer,
  type DiffractionLayerSettings,
} from '../../../web'
import { buildScene, buildSurface } from './build-scene'
import { renderTo } from './render'
import type { SceneDescription, SurfaceDescription } from './scene-description'

/** A scene on whose mesh a material of three's takes the place of the description's. */
export interface LayerRequest {
  scene: SceneDescription
  base: 'standard' | 'physical'
  /** Of the base; colours as linear sRGB. */
  parameters?: {
    color?: [number, number, number]
    emissive?: [number, number, number]
    roughness?: number
    metalness?: number
    clearcoat?: number
    clearcoatRoughness?: number
    specularIntensity?: number
    transmission?: number
  }
  /** Without them there is no layer. */
  layer?: Partial<Omit<DiffractionLayerSettings, 'surface' | 'onError' | 'envMap'>>
  /** A hook of somebody else's that moves the mesh by 0.25 along x and makes it half as red, and when it is set. */
  hook?: 'before' | 'after' | 'around'
  /** Whether the layer is taken off again before it is drawn. */
  removed?: boolean
  /** Surfaces with which the material was drawn before, by one layer or each by its own, removed afterwards. */
  earlier?: { surfaces: SurfaceDescription[]; by: 'one layer' | 'layers' }
  /** Whether the material takes its parameters by `copy`, when it has been drawn with the layer. */
  copied?: boolean
  /** Frames that are drawn; the last one is read. */
  frames?: number
}

export interface LayeredPicture {
  /** Linear sRGB and coverage, rows from top to bottom. */
  pixels: Float32Array
  /** Programs linked in each frame. */
  linked: number[]
  cacheKey: string
  explained: string[]
}

type Shader = Parameters<MeshStandardMaterial['onBeforeCompile']>[0]

const MOVED = '#include <begin_vertex>\n\ttransformed.x += 0.25;'
const HALF_RED = '#include <opaque_fragment>\n\tgl_FragColor.r *= 0.5;'

/** Adds two lines; refuses where they were added already. */
function moveAndTint(shader: Shader): void {
  if (shader.fragmentShader.includes(HALF_RED)) throw new Error('The hook was called twice')
  shader.vertexShader = shader.vertexShader.replace('#include <begin_vertex>', MOVED)
  shader.fragmentShader = shader.fragmentShader.replace('#include <opaque_fragment>', HALF_RED)
}

export async function drawLayer(
  renderer: WebGLRenderer,
  request: LayerRequest,
): Promise<LayeredPicture> {
  const { scene: description, parameters = {}, hook } = request
  const built = await buildScene(description)
  const { color, emissive, ...others } = parameters
  const material = new (request.base === 'physical' ? MeshPhysicalMaterial : MeshStandardMaterial)({
    ...others,
    ...(color && { color: new Color(...color) }),
    ...(emissive && { emissive: new Color(...emissive) }),
    side: built.mesh.material.side,
  })
  if (hook === 'before') material.onBeforeCompile = moveAndTint
  const lay = async (surface: SurfaceDescription): Promise<DiffractionLayer> => {
    const layer = diffractionLayer(material, {
      surface: await buildSurface(surface),
      mapsPath: '/maps/baked/',
      gamut: 'signed',
      ...request.layer,
    })
    await layer.ready
    return layer
  }
  let layer: DiffractionLayer | null = null
  for (const surface of request.earlier?.surfaces ?? []) {
    if (layer === null) layer = await lay(surface)
    else layer.set({ surface: await buildSurface(surface) })
    await layer.ready
    Object.assign(built.mesh, { material })
    renderTo(renderer, built, ...description.size, 1)
    if (request.earlier!.by === 'layers') {
      layer.remove()
      layer = null
    }
  }
  if (layer === null) layer = request.layer ? await lay(description.surface) : null
  else layer.set({ surface: await buildSurface(description.surface) })
  await layer?.ready
  if (hook === 'after') material.onBeforeCompile = moveAndTint
  if (hook === 'around') {
    const found = material.onBeforeCompile.bind(material)
    material.onBeforeCompile = (shader, by) => {
      found(shader, by)
      moveAndTint(shader)
    }
  }
  if (request.removed) layer?.remove()
  Object.assign(built.mesh, { material })
  if (request.copied) {
    renderTo(renderer, built, ...description.size, 1)
    material.copy(material.clone()).needsUpdate = true
  }

  const gl = renderer.getContext()
  const link = gl.linkProgram.bind(gl)
  const linked: number[] = []
  gl.linkProgram = (program) => {
    linked[linked.length - 1]!++
    link(program)
  }
  try {
    let pixels: Float32Array = new Float32Array()
    for (let frame = 0; frame < (request.frames ?? 1); frame++) {
      linked.push(0)
      pixels = renderTo(renderer, built, ...description.size, 1)
    }
    const features = layer?.explain() ?? []
    const explained = features.filter(({ included }) => included).map(({ feature }) => feature)
    return { pixels, linked, explained, cacheKey: material.customProgramCacheKey() }
  } finally {
    gl.linkProgram = link
    built.mesh.material.dispose()
    built.dispose()
  }
}
