import { WebGLRenderer } from 'three'
import { drawLayer, type LayeredPicture, type LayerRequest } from './layer'
import { drawLate, type LateReport } from './late-settings'
import { passThroughGltf, type GltfOutcome, type GltfRequest } from './gltf'
import { countCompilations } from './recompilation'
import { reportRefinement } from './refinement'
import { drawPlanarFrames, type PlanarFrame, type PlanarStep } from './planar'
import { renderScene, type RenderedScene } from './render'
import { countResources, drawRestored, type RestoredReport } from './resources'
import type { SceneDescription } from './scene-description'
import { countReplacing, countSharing } from './shared-textures'
import {
  drawSets,
  type StabilityProgram,
  type StabilityResult,
  type StabilitySet,
} from './stability'
import { probeFeatures } from './three-features'
import { drawVariants } from './variants'
import { timeMaterials, type TimingRequest } from './timing'

/** Float arrays cross from the page to node as base64: as JSON they would take minutes. */
export type Transferred<T> = {
  [K in keyof T]: T[K] extends Float32Array ? string : T[K]
}

export interface Harness {
  /** The name of the renderer behind WebGL. */
  readonly backend: string
  renderScene: (description: SceneDescription) => Promise<TransferredScene>
  timeMaterials: (request: TimingRequest) => Promise<Record<string, number>>
  /** Draws the material in every variant; returns failures by the variant's name. */
  drawVariants: () => Promise<Record<string, string>>
  /** Draws one program with many sets of parameters. */
  drawSets: (program: StabilityProgram, sets: StabilitySet[]) => Promise<StabilityResult[]>
  /** Draws a scene by a material of three's, with a layer or without. */
  drawLayer: (request: LayerRequest) => Promise<Transferred<LayeredPicture>>
  /** Counts the programs that a scene with this surface links as it changes. */
  countCompilations: typeof countCompilations
  /** Counts WebGL's objects while a surface is drawn, and after. */
  countResources: typeof countResources
  /** Counts textures and uploads while materials that share tables come and go. */
  countSharing: typeof countSharing
  /** Likewise while a surface takes another's place. */
  countReplacing: typeof countReplacing
  /** Pictures before a context is lost and after it is restored. */
  drawRestored: (
    ...request: Parameters<typeof drawRestored>
  ) => Promise<Transferred<RestoredReport>>
  /** Pictures while settings change that take long to follow. */
  drawLate: (...request: Parameters<typeof drawLate>) => Promise<Transferred<LateReport>>
  /** What refining a scene at rest does. */
  reportRefinement: typeof reportRefinement
  /** Draws frames of one scene, one for each step. */
  drawPlanarFrames: (scene: SceneDescription, steps: PlanarStep[]) => Promise<PlanarFrame[]>
  /** What of a scene's mesh comes back from a glTF file. */
  passThroughGltf: (request: GltfRequest) => Promise<GltfOutcome>
  /** The colour in the picture's middle with each of three's features. */
  probeFeatures: typeof probeFeatures
}

export type TransferredScene = Transferred<Omit<RenderedScene, 'environment'>> & {
  environment: { width: number; height: number; data: string } | null
}

declare global {
  interface Window {
    harness: Harness
  }
}

const renderer = new WebGLRenderer({ antialias: false, preserveDrawingBuffer: true })
renderer.setSize(16, 16)
document.body.append(renderer.domElement)
renderer.debug.onShaderError = (gl, program, vertex, fragment) => {
  throw new Error(
    [
      gl.getProgramInfoLog(program),
      gl.getShaderInfoLog(vertex),
      gl.getShaderInfoLog(fragment),
    ].join('\n'),
  )
}

window.harness = {
  backend: backendName(),
  renderScene: async (description) => {
    const { radiance, geometry, environment, ...rest } = await renderScene(renderer, description)
    return {
      ...rest,
      radiance: base64(radiance),
      geometry: base64(geometry),
      environment: environment && { ...environment, data: base64(environment.data) },
    }
  },
  timeMaterials: (request) => timeMaterials(renderer, request),
  drawSets: (program, sets) => drawSets(renderer, program, sets),
  drawPlanarFrames: (scene, steps) => drawPlanarFrames(renderer, scene, steps),
  drawVariants,
  drawLayer: async (request) => {
    const { pixels, ...rest } = await drawLayer(renderer, request)
    return { ...rest, pixels: base64(pixels) }
  },
  countCompilations,
  countResources,
  countSharing,
  countReplacing,
  drawRestored: async (...request) => {
    const { before, after, lit } = await drawRestored(...request)
    return { before: base64(before), after: base64(after), lit }
  },
  drawLate: async (...request) => {
    const { textures, ...pictures } = await drawLate(...request)
    const { before, meanwhile, after, fresh } = pictures
    return {
      ...{ before: base64(before), meanwhile: base64(meanwhile) },
      ...{ after: base64(after), fresh: base64(fresh), textures },
    }
  },
  reportRefinement,
  passThroughGltf: (request) => passThroughGltf(renderer, request),
  probeFeatures,
}

function backendName(): string {
  const gl = renderer.getContext()
  const info = gl.getExtension('WEBGL_debug_renderer_info')
  return String(gl.getParameter(info?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER))
}

function base64(floats: Float32Array): string {
  const bytes = new Uint8Array(floats.buffer, floats.byteOffset, floats.byteLength)
  let text = ''
  // String.fromCharCode takes its characters as arguments, of which there may not be too many.
  for (let i = 0; i < bytes.length; i += 0x8000)
    text += String.fromCharCode(...bytes.subarray(i, i + 0x8000))
  return btoa(text)
}
