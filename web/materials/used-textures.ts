import { Texture, type IUniform } from 'three'

/** How many use each texture. */
const users = new WeakMap<Texture, number>()

/** The textures of a material or layer among those that others may use as well: who leaves one as the last frees it. */
export class UsedTextures {
  #used = new Set<Texture>()

  /** Uses the textures among these from now on, and no others. */
  use(uniforms: readonly IUniform[]): void {
    const before = this.#used
    this.#used = new Set(uniforms.map(({ value }) => value as unknown).filter(isTexture))
    for (const texture of this.#used) users.set(texture, (users.get(texture) ?? 0) + 1)
    for (const texture of before) {
      const left = users.get(texture)! - 1
      users.set(texture, left)
      if (left === 0) texture.dispose()
    }
  }
}

function isTexture(value: unknown): value is Texture {
  return value instanceof Texture
}
