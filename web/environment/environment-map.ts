import {
  EquirectangularReflectionMapping,
  EquirectangularRefractionMapping,
  LinearFilter,
  LinearMipmapLinearFilter,
  RepeatWrapping,
  TextureSource,
  UVMapping,
  type CubeTexture,
  type Texture,
} from 'three'
import { refuse } from '../errors.ts'
import { lightTexels } from './light-texels.ts'

/** A texture of the environment in a form the shader can sample at any mip level. */
export interface EnvironmentMap {
  texture: Texture
  isCube: boolean
  /** Angle between two texels of level 0, rad. */
  texel: number
  /** Channels that held what light cannot be, and were repaired. */
  repaired: number
}

interface Copy {
  map: EnvironmentMap
  /** The original's version when the copy was last marked for upload. */
  version: number
}

const copies = new WeakMap<Texture, Copy>()
const originals = new WeakMap<Texture, Texture>()

/**
 * An environment as the shader wants it: mip levels, linear filters, an equirectangular one repeating along u.
 * A copy is made that shares its image where nothing in it needs repair, and the texture given is left as it is. Null as long as the image is not loaded.
 *
 * @param owner - named by errors
 */
export function environmentMap(given: Texture, owner: string): EnvironmentMap | null {
  const texture = originals.get(given) ?? given
  checkEnvironment(texture, owner)
  const isCube = isCubeTexture(texture)
  const size = sizeOf(texture)
  if (size === 0 || (texture.version === 0 && !texture.isRenderTargetTexture)) return null

  let copy = copies.get(texture)
  if (copy === undefined) {
    copy = {
      map: {
        texture: texture.isRenderTargetTexture ? texture : filteredCopy(texture, isCube),
        isCube,
        texel: 0,
        repaired: 0,
      },
      version: -1,
    }
    copies.set(texture, copy)
  }
  if (copy.version !== texture.version && !texture.isRenderTargetTexture) {
    copy.version = texture.version
    copy.map.repaired = takeImage(copy.map.texture, texture)
    copy.map.texture.needsUpdate = true
  }
  copy.map.texel = isCube ? Math.PI / 2 / size : Math.PI / size
  return copy.map
}

function filteredCopy(texture: Texture, isCube: boolean): Texture {
  const copy = texture.clone()
  // Without this, three would turn an equirectangular `envMap` into a cube of its own before each first use.
  if (!isCube) copy.mapping = UVMapping
  if (!isCube) copy.wrapS = RepeatWrapping
  copy.magFilter = LinearFilter
  copy.minFilter = LinearMipmapLinearFilter
  copy.generateMipmaps = copy.mipmaps.length === 0
  copy.needsUpdate = true
  originals.set(copy, texture)
  texture.addEventListener('dispose', () => {
    copies.delete(texture)
    copy.dispose()
  })
  return copy
}

/** Gives the copy the original's image, repaired where it needs to be; returns how many channels were. */
function takeImage(copy: Texture, original: Texture): number {
  copy.source = original.source
  const image = original.image as { data?: unknown } | null
  const data = image?.data
  if (!(data instanceof Float32Array || data instanceof Uint16Array)) return 0
  const light = lightTexels(data)
  if (light.changed > 0) copy.source = new TextureSource({ ...image, data: light.data })
  return light.changed
}

/** Refuses textures that hold no plain environment, in the name of who was given it. */
export function checkEnvironment(given: Texture, owner: string): void {
  const texture = originals.get(given) ?? given
  const isPrefiltered = texture.isPMREMTexture
  const isEquirect =
    texture.mapping === EquirectangularReflectionMapping ||
    texture.mapping === EquirectangularRefractionMapping
  if (isPrefiltered || !(isEquirect || isCubeTexture(texture)))
    refuse(
      owner,
      'envMap',
      isPrefiltered ? 'the output of PMREMGenerator' : `mapping ${texture.mapping}`,
      'an equirectangular texture (EquirectangularReflectionMapping) or a cube texture, not filtered beforehand',
    )
}

function isCubeTexture(texture: Texture): boolean {
  return (texture as Partial<CubeTexture>).isCubeTexture === true
}

/** Height of the image in texels; 0 while it is missing. */
function sizeOf(texture: Texture): number {
  const image: unknown = texture.image
  const first: unknown = Array.isArray(image) ? image[0] : image
  if (typeof first !== 'object' || first === null) return 0
  const holder = 'image' in first ? first.image : first
  if (typeof holder !== 'object' || holder === null) return 0
  return 'height' in holder && typeof holder.height === 'number' ? holder.height : 0
}
