import { DataTexture, EquirectangularReflectionMapping } from 'three'
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js'
import { lightTexels } from '../../web'
import { meanLuminance } from './mean-luminance'

/** Environments to choose from: names in @pmndrs/assets/hdri, and what they show. */
export const ENVIRONMENTS = {
  studio: 'Studio',
  lab: 'Laboratory',
  warehouse: 'Warehouse',
  workshop: 'Workshop',
  apartment: 'Apartment',
  lobby: 'Lobby',
  hall: 'Hall',
  venice: 'Venice, dawn',
  dawn: 'Dawn',
  sunrise: 'Sunrise',
  sky: 'Sky',
  park: 'Park',
  forest: 'Forest',
  bridge: 'Bridge',
  esplanade: 'Esplanade',
  city: 'City',
  sunset: 'Sunset',
  night: 'Night street',
} as const
export type EnvironmentName = keyof typeof ENVIRONMENTS

/** Each is a module of its own, whose only export is the file as a data address: what is not chosen is not fetched. */
const modules = import.meta.glob<string>('../../node_modules/@pmndrs/assets/hdri/*.exr.js', {
  import: 'default',
})

export interface Environment {
  texture: DataTexture
  /** Channels of its texels that held what light cannot be, and were repaired. */
  repaired: number
  channels: number
  /** Mean luminance over all directions, as the file counts it. */
  mean: number
}

const loads = new Map<EnvironmentName, Promise<Environment>>()

/** Loads an environment, once. */
export function loadEnvironment(name: EnvironmentName): Promise<Environment> {
  const known = loads.get(name)
  if (known !== undefined) return known
  const load = fetchEnvironment(name)
  loads.set(name, load)
  load.catch(() => loads.delete(name))
  return load
}

export function isEnvironmentName(name: string | null): name is EnvironmentName {
  return name !== null && name in ENVIRONMENTS
}

async function fetchEnvironment(name: EnvironmentName): Promise<Environment> {
  const fetchModule = modules[`../../node_modules/@pmndrs/assets/hdri/${name}.exr.js`]
  if (fetchModule === undefined) throw new Error(`@pmndrs/assets has no environment ${name}`)
  const texture = await new EXRLoader().loadAsync(await fetchModule())
  texture.mapping = EquirectangularReflectionMapping
  const image = texture.image as { width: number; height: number; data: Uint16Array }
  // Here and not only in the material, since the background shows the same texture.
  const { data, changed } = lightTexels(image.data)
  image.data = data
  return {
    texture,
    repaired: changed,
    channels: data.length,
    mean: meanLuminance(data, image.width, image.height),
  }
}
