import { readFile } from 'node:fs/promises'
import type { TransferredScene } from './harness/harness'
import type { SceneDescription } from './harness/scene-description'
import { openHarness } from './open-harness.mjs'

export type Vector = [number, number, number]

/** A rendered scene whose pixels can be asked for; rows count from the top. */
export class Rendering {
  readonly width: number
  readonly height: number
  readonly #radiance: Float32Array
  readonly #geometry: Float32Array
  readonly environment: { width: number; height: number; data: Float32Array } | null

  constructor(scene: TransferredScene) {
    this.width = scene.width
    this.height = scene.height
    this.#radiance = floats(scene.radiance)
    this.#geometry = floats(scene.geometry)
    this.environment = scene.environment && {
      ...scene.environment,
      data: floats(scene.environment.data),
    }
  }

  get radiance(): Float32Array {
    return this.#radiance
  }

  get geometry(): Float32Array {
    return this.#geometry
  }

  /** Numbers of the pixels where the surface is. */
  get covered(): number[] {
    const pixels: number[] = []
    for (let i = 0; i < this.width * this.height; i++)
      if (this.#geometry[4 * i + 3] === 1) pixels.push(i)
    return pixels
  }

  /** Linear sRGB of a pixel. */
  rgb(pixel: number): Vector {
    return triple(this.#radiance, 4 * pixel)
  }

  /** A vector of a pixel's geometry, view space. */
  vector(layer: 'position' | 'normal' | 'tangent' | 'grating', pixel: number): Vector {
    const index = ['position', 'normal', 'tangent', 'grating'].indexOf(layer)
    return triple(this.#geometry, 4 * (index * this.width * this.height + pixel))
  }
}

export type HarnessHandle = Awaited<ReturnType<typeof openHarness>>

export async function render(harness: HarnessHandle, scene: SceneDescription): Promise<Rendering> {
  return new Rendering(await harness.renderScene(scene))
}

export async function readScene(name: string): Promise<SceneDescription> {
  const file = new URL(`../scenes/${name}.json`, import.meta.url)
  return JSON.parse(await readFile(file, 'utf8')) as SceneDescription
}

export function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

export function cross(a: Vector, b: Vector): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

export function normalized(a: Vector): Vector {
  const length = Math.sqrt(dot(a, a))
  return [a[0] / length, a[1] / length, a[2] / length]
}

function triple(values: Float32Array, index: number): Vector {
  return [values[index]!, values[index + 1]!, values[index + 2]!]
}

export function floats(base64: string): Float32Array {
  const bytes = Buffer.from(base64, 'base64')
  return new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength))
}
