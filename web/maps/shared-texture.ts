import { LinearFilter, NearestFilter, type Texture } from 'three'
import type { Steps } from '../steps.ts'
import type { LoadedMap } from './load.ts'

const made = new WeakMap<LoadedMap, Map<string, Texture>>()

/** A texture made of a map, once for all materials that read it; `name` tells a map's textures apart. */
export function sharedTexture<T extends Texture>(map: LoadedMap, name: string, make: () => T): T {
  let textures = made.get(map)
  if (textures === undefined) made.set(map, (textures = new Map<string, Texture>()))
  let texture = textures.get(name)
  if (texture === undefined) textures.set(name, (texture = make()))
  return texture as T
}

/** What was begun last of each map and may not be finished. */
const begun = new WeakMap<LoadedMap, { name: string; steps: Steps<Texture> }>()

/**
 * Likewise, of what takes long to make: no step where it was made before. Whoever wants what another has begun goes on with it.
 */
export function* sharedInSteps<T extends Texture>(
  map: LoadedMap,
  name: string,
  make: () => Steps<T>,
): Steps<T> {
  const known = made.get(map)?.get(name)
  if (known !== undefined) return known as T
  const last = begun.get(map)
  const work = last?.name === name ? last : { name, steps: make() as Steps<Texture> }
  begun.set(map, work)
  for (;;) {
    yield
    try {
      const step = work.steps.next()
      // One that another has finished is found where that one put it.
      if (step.done === true) return sharedTexture(map, name, () => step.value as T)
    } catch (error) {
      // What has failed would go on as if it were done.
      work.steps = make()
      throw error
    }
  }
}

/** Texels as they are, without blending between them. */
export function unfiltered<T extends Texture>(texture: T): T {
  return read(texture, NearestFilter)
}

/** Linear between texels. */
export function filtered<T extends Texture>(texture: T): T {
  return read(texture, LinearFilter)
}

function read<T extends Texture>(
  texture: T,
  filter: typeof NearestFilter | typeof LinearFilter,
): T {
  texture.minFilter = texture.magFilter = filter
  texture.needsUpdate = true
  return texture
}
