import { DataUtils, Matrix3, Matrix4, Euler, type Texture, type Vector3 } from 'three'
import type { Colour } from './light-spectrum'

/** Texels of an environment: linear sRGB, never negative, rows from the picture's bottom, as textures have them. */
interface Texels {
  width: number
  height: number
  rgb: Float32Array
}

/** Made once of each texture, whichever way it is turned. */
const made = new WeakMap<Texture, Texels>()

/** An equirectangular environment, read on the processor. */
export class EnvironmentLight {
  readonly width: number
  readonly height: number
  readonly #texels: Texels
  readonly #turn: Matrix3

  /**
   * @param texture - of half floats, four channels
   * @param rotation - the scene's environmentRotation
   * @param intensity - factor on its radiance
   */
  constructor(
    texture: Texture,
    rotation: Euler,
    readonly intensity: number,
  ) {
    this.#texels = texelsOf(texture)
    this.width = this.#texels.width
    this.height = this.#texels.height
    // three takes world directions to the texture's by the transpose of the rotation.
    this.#turn = new Matrix3()
      .setFromMatrix4(new Matrix4().makeRotationFromEuler(rotation))
      .transpose()
  }

  /** Where a direction of the world lies in the picture, 0 to 1 from the left and from the top: three's equirectUv. */
  place(x: number, y: number, z: number): { x: number; y: number } {
    const m = this.#turn.elements
    const [dx, dy, dz] = [
      m[0] * x + m[3] * y + m[6] * z,
      m[1] * x + m[4] * y + m[7] * z,
      m[2] * x + m[5] * y + m[8] * z,
    ]
    const u = Math.atan2(dz, dx) / (2 * Math.PI) + 0.5
    const v = Math.asin(Math.min(Math.max(dy, -1), 1)) / Math.PI + 0.5
    return { x: u, y: 1 - v }
  }

  /** A texel's radiance, linear sRGB, rows from the picture's top. */
  texel(column: number, row: number): Colour {
    const { width, height, rgb } = this.#texels
    const at = 3 * ((height - 1 - row) * width + column)
    return [0, 1, 2].map((c) => rgb[at + c]! * this.intensity) as Colour
  }

  /** As a surface sees it. axes: t, b, n in the world, orthonormal. */
  around(axes: readonly [Vector3, Vector3, Vector3]): LocalEnvironment {
    const turned = axes.map((axis) => axis.clone().applyMatrix3(this.#turn))
    return new LocalEnvironment(
      this.#texels,
      this.intensity,
      turned.flatMap((a) => a.toArray()),
    )
  }
}

/** An environment in a surface's own axes. It is read often: nothing is allocated. */
export class LocalEnvironment {
  /** Angle between two texels, rad. */
  readonly texel: number
  readonly #rgb: Float32Array
  readonly #width: number
  readonly #height: number
  readonly #axes: Float64Array

  /** @param axes - t, b, n as the picture has them, three numbers each */
  constructor(
    { rgb, width, height }: Texels,
    readonly intensity: number,
    axes: readonly number[],
  ) {
    this.texel = Math.PI / height
    this.#rgb = rgb
    this.#width = width
    this.#height = height
    this.#axes = Float64Array.from(axes)
  }

  /**
   * Adds a share of the radiance from a unit direction, blended between texels, to three numbers of a sum: linear sRGB.
   *
   * @param at - index of the first
   */
  add(t: number, b: number, n: number, share: number, sum: Float64Array, at = 0): void {
    const a = this.#axes
    const width = this.#width
    const rgb = this.#rgb
    const x = a[0]! * t + a[3]! * b + a[6]! * n
    const y = a[1]! * t + a[4]! * b + a[7]! * n
    const z = a[2]! * t + a[5]! * b + a[8]! * n
    const column = (Math.atan2(z, x) / (2 * Math.PI) + 0.5) * width - 0.5
    const rise = Math.asin(Math.min(Math.max(y, -1), 1)) / Math.PI + 0.5
    const row = Math.min(Math.max(rise * this.#height - 0.5, 0), this.#height - 1)
    const left = Math.floor(column)
    const low = Math.min(Math.floor(row), this.#height - 2)
    const right = left + 1 === width ? 0 : left + 1
    const i = 3 * (low * width + (left < 0 ? width - 1 : left))
    const j = 3 * (low * width + right)
    const up = 3 * width
    const factor = share * this.intensity
    const above = factor * (row - low)
    const below = factor - above
    const towards = column - left
    const q = below * towards
    const p = below - q
    const s = above * towards
    const r = above - s
    sum[at]! += p * rgb[i]! + q * rgb[j]! + r * rgb[i + up]! + s * rgb[j + up]!
    sum[at + 1]! += p * rgb[i + 1]! + q * rgb[j + 1]! + r * rgb[i + up + 1]! + s * rgb[j + up + 1]!
    sum[at + 2]! += p * rgb[i + 2]! + q * rgb[j + 2]! + r * rgb[i + up + 2]! + s * rgb[j + up + 2]!
  }
}

function texelsOf(texture: Texture): Texels {
  const known = made.get(texture)
  if (known !== undefined) return known
  const { width, height, data } = texture.image as {
    width: number
    height: number
    data: Uint16Array
  }
  const rgb = new Float32Array(3 * width * height)
  for (let i = 0; i < width * height; i++)
    for (let c = 0; c < 3; c++)
      // Light cannot be negative; some published environments are.
      rgb[3 * i + c] = Math.max(DataUtils.fromHalfFloat(data[4 * i + c]!), 0)
  const texels = { width, height, rgb }
  made.set(texture, texels)
  return texels
}
