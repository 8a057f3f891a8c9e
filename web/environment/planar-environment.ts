import {
  Matrix3,
  type BufferGeometry,
  type Camera,
  type Object3D,
  type Side,
  type Texture,
  type Vector3,
  type WebGLRenderer,
} from 'three'
import { drawsHalfFloats } from './full-screen-pass.ts'
import { meshPlane } from './mesh-plane.ts'
import { PlanarTable, type PlanarOptics } from './planar-table.ts'

/** Below this roughness (rad) a mirror image has more detail than a table can hold. */
export const SMALLEST_ROUGHNESS = 0.0087

/** Frames for which plane, environment and optics must have rested before a table is made again. */
const RESTING_FRAMES = 2

/** What a material knows of a draw. */
export interface PlanarDraw {
  renderer: WebGLRenderer
  camera: Camera
  object: Object3D
  geometry: BufferGeometry
  side: Side
  /** cos θ, sin θ and frequency (1/µm) of the surface's gratings; null where they are not the same everywhere. */
  gratings: readonly Vector3[] | null
  /** Why the material's normals or method rule a table out; null where they do not. */
  obstacle: string | null
  /** Null where there is none. */
  environment: Texture | null
  /** The environment's turn, from the world to the texture. */
  rotation: Matrix3
  optics: PlanarOptics
  /** Counts changes of the optics. */
  opticsVersion: number
}

/** All that a table depends on: things that are the same or not, and numbers. */
interface Key {
  things: unknown[]
  numbers: number[]
}

/**
 * Decides at each draw whether a table of the environment's light serves, and makes it when all it depends on has
 * come to rest.
 */
export class PlanarEnvironment {
  /** Why the last draw had a table or none. */
  why = 'nothing has been drawn'
  #table: PlanarTable | null = null
  /** What the table was made for. */
  #made: Key | null = null
  /** What the last draws needed, and for how many frames nothing else was needed. */
  #seen: Key | null = null
  #frame = -1
  #rested = 0
  readonly #plane = new Matrix3()

  get texture(): Texture | null {
    return this.#table?.texture ?? null
  }

  /** Whether the draw can read the table, which may be made now. */
  follow(draw: PlanarDraw): boolean {
    const obstacle = this.#obstacle(draw)
    if (obstacle !== null) {
      this.why = obstacle
      return false
    }
    const isFirst = this.#seen === null
    const key = keyOf(draw, this.#plane)
    const isChanged = this.#isChanged(key, draw.renderer)
    if (!isFirst && isChanged) {
      this.why = 'the plane, the environment or the optics have just changed'
      return false
    }
    const isFor = this.#made !== null && isSame(this.#made, key)
    if (!isFor || !this.#table!.isOn(draw.renderer)) {
      if (!isFirst && this.#rested < RESTING_FRAMES) {
        this.why = `plane, environment and optics have not rested for ${RESTING_FRAMES} frames`
        return false
      }
      this.#make(draw, key)
    }
    this.why = `the mesh is flat and rests: ${this.#table!.layers} gratings in a table over the view`
    return true
  }

  dispose(): void {
    this.#table?.dispose()
    this.#table = null
    this.#made = this.#seen = null
  }

  #obstacle(draw: PlanarDraw): string | null {
    const { renderer, object, geometry, side, camera, environment, optics } = draw
    const roughness = optics.uniforms.uRoughness!.value as number
    if (environment === null) return 'there is no environment'
    if (draw.obstacle !== null) return draw.obstacle
    if (draw.gratings === null)
      return 'the surface is not made of gratings that are the same everywhere'
    if (roughness < SMALLEST_ROUGHNESS)
      return `roughness is below ${SMALLEST_ROUGHNESS} rad: too sharp for a table`
    if (environment.isRenderTargetTexture) return 'the environment is drawn, and may change unseen'
    if (!meshPlane(object, geometry, side, camera, this.#plane))
      return 'the mesh is not one plane with straight uv'
    if (!drawsHalfFloats(renderer)) return 'the device cannot draw to half floats'
    return null
  }

  /** Compares with the draws before, two planes of one frame among them, and counts the frames that were the same. */
  #isChanged(key: Key, { info }: WebGLRenderer): boolean {
    const isChanged = this.#seen === null || !isSame(this.#seen, key)
    // What it was at first stays: a slow turn is a change in the end.
    if (isChanged) this.#seen = key
    if (isChanged) this.#rested = 0
    else if (info.render.frame !== this.#frame) this.#rested++
    this.#frame = info.render.frame
    return isChanged
  }

  #make({ renderer, camera, optics, gratings }: PlanarDraw, key: Key): void {
    const layers = gratings!.length
    if (this.#table?.layers !== layers) {
      this.#table?.dispose()
      this.#table = new PlanarTable(layers)
    }
    this.#table.fill(renderer, optics, this.#plane, gratings!, camera)
    this.#made = key
  }
}

/** Planes and gratings that differ by less than this, rad and 1/µm, are the same: a hundredth of the blur. */
const TOLERANCE = 0.01 * SMALLEST_ROUGHNESS

function keyOf(draw: PlanarDraw, plane: Matrix3): Key {
  const { renderer, environment, rotation, gratings, opticsVersion } = draw
  return {
    things: [renderer, environment, environment!.version, opticsVersion, gratings!.length],
    numbers: [
      ...plane.elements,
      ...rotation.elements,
      ...gratings!.flatMap((grating) => grating.toArray()),
    ],
  }
}

function isSame(a: Key, b: Key): boolean {
  return (
    a.things.every((thing, i) => thing === b.things[i]) &&
    a.numbers.every((number, i) => Math.abs(number - b.numbers[i]!) < TOLERANCE)
  )
}
