import type { MeshStandardMaterial } from 'three'

type DefineValues = Record<string, string | number>

/**
 * A layer's defines among those of its material. Others may add to the material's, or replace them as three's `copy` does:
 * the layer's stay, last and in their own order, so that a class of scene that was drawn before finds its program.
 */
export class LayerDefines {
  readonly #material: MeshStandardMaterial
  /** What the material shows: others' and the layer's. */
  #shown: DefineValues
  #layers: DefineValues = {}
  /** Others' that the layer's hide. */
  #hidden: DefineValues = {}

  constructor(material: MeshStandardMaterial) {
    this.#material = material
    this.#shown = definesOf(material)
    Object.defineProperty(material, 'defines', {
      configurable: true,
      enumerable: true,
      get: () => this.#shown,
      set: (others: DefineValues | undefined) => {
        this.#show(others ?? {})
      },
    })
  }

  /** Shows these of the layer in place of those before. */
  use(values: DefineValues): void {
    const others = this.#others()
    this.#layers = values
    this.#show(others)
    this.#material.needsUpdate = true
  }

  /** Leaves the material with others' alone. */
  remove(): void {
    Object.defineProperty(this.#material, 'defines', { value: this.#others(), writable: true })
    this.#material.needsUpdate = true
  }

  #show(others: DefineValues): void {
    this.#hidden = pick(others, (name) => name in this.#layers)
    this.#shown = { ...others, ...this.#layers }
  }

  /** In the order in which they were set, as three tells programs by. */
  #others(): DefineValues {
    const isOthers = (name: string): boolean => !(name in this.#layers) || name in this.#hidden
    return { ...pick(this.#shown, isOthers), ...this.#hidden }
  }
}

function definesOf(material: MeshStandardMaterial): DefineValues {
  return (material.defines ?? {}) as DefineValues
}

function pick(values: DefineValues, isPicked: (name: string) => boolean): DefineValues {
  return Object.fromEntries(Object.entries(values).filter(([name]) => isPicked(name)))
}
