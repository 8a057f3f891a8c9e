import { DataUtils, Matrix3, Matrix4, Euler, type Texture } from 'three'
import type { Colour } from './light-spectrum'

/** An equirectangular environment, read on the processor. */
export class EnvironmentLight {
  readonly width: number
  readonly height: number
  readonly #data: Uint16Array
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
    const image = texture.image as { width: number; height: number; data: Uint16Array }
    this.width = image.width
    this.height = image.height
    this.#data = image.data
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

  /** Radiance from a direction of the world, linear sRGB, blended between texels. */
  radiance(x: number, y: number, z: number): Colour {
    const place = this.place(x, y, z)
    const column = place.x * this.width - 0.5
    const row = place.y * this.height - 0.5
    const [left, top] = [Math.floor(column), Math.floor(row)]
    const [s, t] = [column - left, row - top]
    const mix = (c: number): number =>
      (1 - t) * ((1 - s) * this.#at(left, top, c) + s * this.#at(left + 1, top, c)) +
      t * ((1 - s) * this.#at(left, top + 1, c) + s * this.#at(left + 1, top + 1, c))
    return [mix(0) * this.intensity, mix(1) * this.intensity, mix(2) * this.intensity]
  }

  /** A texel's radiance, linear sRGB, rows from the picture's top. */
  texel(column: number, row: number): Colour {
    return [0, 1, 2].map((c) => this.#at(column, row, c) * this.intensity) as Colour
  }

  #at(column: number, row: number, channel: number): number {
    const x = ((column % this.width) + this.width) % this.width
    const y = Math.min(Math.max(row, 0), this.height - 1)
    // EXR rows come from the bottom up, as textures have them.
    return DataUtils.fromHalfFloat(
      this.#data[4 * ((this.height - 1 - y) * this.width + x) + channel]!,
    )
  }
}
