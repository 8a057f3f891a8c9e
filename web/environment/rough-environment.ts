import type {
  BufferGeometry,
  Camera,
  IUniform,
  Matrix3,
  Object3D,
  Side,
  Vector3,
  WebGLRenderer,
} from 'three'
import { floatLiteral } from '../glsl/float-literal.ts'
import { BLURRED_LAYERS, BlurredEnvironment } from './blurred-environment.ts'
import type { EnvironmentMap } from './environment-map.ts'
import { PlanarEnvironment } from './planar-environment.ts'
import { PLANAR_TEXELS } from './planar-table.ts'

/** What a material knows of a draw. */
export interface RoughDraw {
  renderer: WebGLRenderer
  camera: Camera
  object: Object3D
  geometry: BufferGeometry
  side: Side
  /** Null where there is none. */
  environment: EnvironmentMap | null
  /** cos θ, sin θ and frequency (1/µm) of the surface's gratings; null where they are not the same everywhere. */
  gratings: readonly Vector3[] | null
  /** Why the material's normals or method rule a table out; null where they do not. */
  obstacle: string | null
  /** Whether the optics read blurred layers where there is no table. */
  blurs: boolean
  /** rad */
  roughness: number
  defines: Record<string, unknown>
  uniforms: Record<string, IUniform>
  /** Counts changes of the optics. */
  opticsVersion: number
}

/** Why a rough surface reads what it reads of its environment. */
export interface RoughReasons {
  planar: string
  blur: string
}

/** What the environment of a rough surface is read from, besides its own texels: a table where a mesh is flat, else Gaussians. */
export class RoughEnvironment {
  readonly #planar = new PlanarEnvironment()
  readonly #blurred = new BlurredEnvironment()
  #why = ''

  get why(): RoughReasons {
    return { planar: this.#planar.why, blur: this.#why }
  }

  /**
   * Makes what the draw reads, if it is not there, and puts it into the uniforms.
   *
   * @returns the defines that this asks for
   */
  follow(draw: RoughDraw): { PLANAR_TEXELS: string | false; BLURRED_LAYERS: number | false } {
    const { renderer, camera, environment, uniforms, roughness } = draw
    const isPlanar =
      'DIFFRACTION' in draw.defines &&
      this.#planar.follow({
        ...draw,
        environment: environment?.texture ?? null,
        rotation: uniforms.uEnvironmentRotation!.value as Matrix3,
        optics: { defines: draw.defines, uniforms },
      })
    uniforms.uPlanarEnvironment!.value = this.#planar.texture
    const isBlurred =
      'DIFFRACTION' in draw.defines &&
      draw.blurs &&
      !isPlanar &&
      this.#blurred.follow({ renderer, camera, environment, roughness })
    uniforms.uBlurredLayers!.value = this.#blurred.texture
    uniforms.uBlurUnit!.value = isBlurred ? BlurredEnvironment.unit(roughness) : 1
    if (!draw.blurs) this.#why = 'the method blurs by mip levels'
    else this.#why = isPlanar ? 'a flat surface has its table' : this.#blurred.why
    return {
      PLANAR_TEXELS: isPlanar && floatLiteral(PLANAR_TEXELS),
      BLURRED_LAYERS: isBlurred && BLURRED_LAYERS,
    }
  }

  dispose(): void {
    this.#planar.dispose()
    this.#blurred.dispose()
  }
}
