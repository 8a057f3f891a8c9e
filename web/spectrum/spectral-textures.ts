import type { DataTexture } from 'three'
import type { LoadedMap } from '../maps/load'
import type { Metal } from '../surfaces/surface'
import { lobeTexture } from './lobe-texture'
import { metalReflectance } from './metal-reflectance'
import { nodesTexture, spectralNodes, type Placement } from './spectral-nodes'

const made = new WeakMap<LoadedMap, Map<string, DataTexture>>()

/** The spectral textures of one illuminant seen in one metal; each is made once and shared by all materials. */
export class SpectralTextures {
  readonly #reflectance: (wavelength: number) => number

  constructor(
    private readonly lobes: LoadedMap,
    metals: LoadedMap,
    /** null: a perfect mirror */
    private readonly metal: Metal | null,
  ) {
    this.#reflectance = metal === null ? () => 1 : metalReflectance(metals, metal)
  }

  lobe(): DataTexture {
    return this.#once('lobe', () => lobeTexture(this.lobes, this.#reflectance))
  }

  nodes(count: number, placement: Placement): DataTexture {
    return this.#once(`${placement} ${count}`, () =>
      nodesTexture(spectralNodes(this.lobes, count, placement), this.#reflectance),
    )
  }

  #once(name: string, make: () => DataTexture): DataTexture {
    let textures = made.get(this.lobes)
    if (textures === undefined) made.set(this.lobes, (textures = new Map<string, DataTexture>()))
    const key = `${this.metal ?? 'mirror'} ${name}`
    let texture = textures.get(key)
    if (texture === undefined) textures.set(key, (texture = make()))
    return texture
  }
}
