import type { DataTexture } from 'three'
import type { LoadedMap } from '../maps/load.ts'
import { sharedTexture } from '../maps/shared-texture.ts'
import type { Metal } from '../surfaces/surface.ts'
import { arcNodes } from './arc-nodes.ts'
import { lobeTexture } from './lobe-texture.ts'
import { metalReflectance } from './metal-reflectance.ts'
import {
  nodesTexture,
  seenIn,
  spectralNodes,
  type Placement,
  type SpectralNode,
} from './spectral-nodes.ts'

/** The spectral textures of one illuminant seen in one metal; each is made once and shared by all materials. */
export class SpectralTextures {
  readonly #reflectance: (wavelength: number) => number
  readonly #arcs: Record<string, SpectralNode[]> = {}

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
      nodesTexture(seenIn(spectralNodes(this.lobes, count, placement), this.#reflectance)),
    )
  }

  arcNodes(count: number): DataTexture {
    return this.#once(`arc ${count}`, () => nodesTexture(this.#arc(count, 1)))
  }

  /** Those of `arcNodes(count)`, and then those of so many frames that share a spectrum. */
  refinedArcNodes(count: number, frames: number): DataTexture {
    return this.#once(`arc ${count} of ${frames}`, () =>
      nodesTexture([...this.#arc(count, 1), ...this.#arc(count, frames)]),
    )
  }

  /** Made once for the two textures above, which are asked for in the same frame. */
  #arc(count: number, frames: number): SpectralNode[] {
    return (this.#arcs[`${count} ${frames}`] ??= arcNodes(
      this.lobes,
      count,
      this.#reflectance,
      frames,
    ))
  }

  #once(name: string, make: () => DataTexture): DataTexture {
    return sharedTexture(this.lobes, `${this.metal ?? 'mirror'} ${name}`, make)
  }
}
