import {
  DataTexture,
  DataUtils,
  EquirectangularReflectionMapping,
  FloatType,
  LinearFilter,
  RGBAFormat,
  type Texture,
} from 'three'
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js'
import type { EnvironmentDescription } from './scene-description'

/** The environments of @pmndrs/assets, by name, as data addresses. */
const assets = import.meta.glob<string>('../../../node_modules/@pmndrs/assets/hdri/*.exr.js', {
  import: 'default',
})

/** Loads or makes an equirectangular environment. */
export async function loadEnvironment(description: EnvironmentDescription): Promise<DataTexture> {
  const texture =
    'constant' in description
      ? constantTexture(description.constant)
      : await new EXRLoader().loadAsync(
          'asset' in description ? await assetUrl(description.asset) : description.equirect,
        )
  texture.mapping = EquirectangularReflectionMapping
  return texture
}

/** The texture's texels as linear RGBA floats, rows as they are stored: the first is v = 0. */
export function environmentTexels(texture: Texture): {
  width: number
  height: number
  data: Float32Array
} {
  const { width, height, data } = texture.image as {
    width: number
    height: number
    data: Float32Array | Uint16Array
  }
  const floats =
    data instanceof Float32Array ? data : Float32Array.from(data, (h) => DataUtils.fromHalfFloat(h))
  return { width, height, data: floats }
}

async function assetUrl(name: string): Promise<string> {
  const load = assets[`../../../node_modules/@pmndrs/assets/hdri/${name}.exr.js`]
  if (load === undefined)
    throw new Error(`No environment ${name}; there are ${Object.keys(assets).join(', ')}`)
  return load()
}

function constantTexture([r, g, b]: [number, number, number]): DataTexture {
  const width = 64
  const height = 32
  const data = new Float32Array(width * height * 4)
  for (let i = 0; i < width * height; i++) data.set([r, g, b, 1], 4 * i)
  const texture = new DataTexture(data, width, height, RGBAFormat, FloatType)
  texture.magFilter = texture.minFilter = LinearFilter
  texture.needsUpdate = true
  return texture
}
