import {
  DataTexture,
  DataUtils,
  EquirectangularReflectionMapping,
  FloatType,
  HalfFloatType,
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

/** A grey sky with a sun of 1e5 (in halves without end), a black ground, and texels that no light can be. */
export function harshEnvironment(type: 'float' | 'half'): DataTexture {
  const { width, height } = MADE_SIZE
  const data = new Float32Array(width * height * 4)
  data.fill(0.5, data.length / 2)
  data.set([1e5, 8e4, 6e4, 1], 4 * (24 * width + 40))
  data.set([-149, 1, -1e30, 1], 4 * (20 * width + 10))
  data.set([Infinity, 0.2, NaN, 1], 4 * (22 * width + 50))
  data.set([-Infinity, -0, 1, 1], 4 * (28 * width + 5))
  const texture = type === 'float' ? floatTexture(data) : halfTexture(data)
  texture.mapping = EquirectangularReflectionMapping
  return texture
}

function halfTexture(data: Float32Array): DataTexture {
  const { width, height } = MADE_SIZE
  const halves = Uint16Array.from(data, (value) =>
    Math.abs(value) > 65504 ? (value > 0 ? 0x7c00 : 0xfc00) : DataUtils.toHalfFloat(value),
  )
  return filtered(new DataTexture(halves, width, height, RGBAFormat, HalfFloatType))
}

const MADE_SIZE = { width: 64, height: 32 } as const

function constantTexture([r, g, b]: [number, number, number]): DataTexture {
  const { width, height } = MADE_SIZE
  const data = new Float32Array(width * height * 4)
  for (let i = 0; i < width * height; i++) data.set([r, g, b, 1], 4 * i)
  return floatTexture(data)
}

function floatTexture(data: Float32Array): DataTexture {
  const { width, height } = MADE_SIZE
  return filtered(new DataTexture(data, width, height, RGBAFormat, FloatType))
}

function filtered(texture: DataTexture): DataTexture {
  texture.magFilter = texture.minFilter = LinearFilter
  texture.needsUpdate = true
  return texture
}
