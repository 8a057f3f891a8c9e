import { createHash } from 'node:crypto'
import { tableOf } from '../../web/gltf/tables'
import type { LoadedMap } from '../../web/maps/load'
import type { DiffractionMaterial } from '../../web/materials/DiffractionMaterial'
import { DEFAULT_SETTINGS } from '../../web/materials/options'
import { Foil } from '../../web/surfaces/foil'
import { Grating } from '../../web/surfaces/grating'
import { HeightField } from '../../web/surfaces/height-field'

/** All that a material says of itself, to be compared; maps by their contents, wherever they were loaded from. */
export async function stateOf(material: DiffractionMaterial): Promise<object> {
  const { metal, illuminant, observer, energy, method, efficiencies } = material
  const { roughness, coherence, wavelengthStep, environmentNodes, maxError, given } = material
  const { lightAngularRadius, coat, coatIor, coatRoughness, color, gamut } = material
  const { planarEnvironment, diffraction, name, side, transparent, opacity, userData } = material
  return {
    surface: await surfaceState(material),
    illuminant: await tableState(material, illuminant),
    given: [...given].filter((setting) => CHOSEN.includes(setting)).sort(),
    color: color.toArray(),
    ...{ metal, observer, energy, method, efficiencies, roughness, coherence, wavelengthStep },
    ...{ environmentNodes, maxError, lightAngularRadius, coat, coatIor, coatRoughness, gamut },
    ...{ planarEnvironment, diffraction, name, side, transparent, opacity, userData },
  }
}

/** Settings of which it matters whether they were given. */
const CHOSEN = ['energy', 'method', 'efficiencies', 'wavelengthStep', 'environmentNodes']

async function surfaceState(material: DiffractionMaterial): Promise<object> {
  const { surface, method, mapsPath } = material
  if (surface instanceof Grating) {
    const { period, height, profile, orientation, tracks, strength } = surface
    const state = { period, height, profile: await tableState(material, profile) }
    return { ...state, orientation, tracks, strength }
  }
  if (surface instanceof Foil) {
    const { map, height, profile, repeat, filtered } = surface
    const state = { height, profile: await tableState(material, profile), filtered }
    return { map: mapState(map), ...state, repeat: repeat.toArray() }
  }
  if (surface instanceof HeightField) {
    const { orientation, strength, ior, tiles } = surface
    const { relief } = surface.tables({ ...DEFAULT_SETTINGS, method }, mapsPath)
    const map = mapState(await tableOf(material, relief!))
    return { map, orientation, strength, ior, tiles }
  }
  throw new Error(surface.name)
}

/** A name, or what the map has. */
async function tableState(material: DiffractionMaterial, table: string): Promise<unknown> {
  return table.includes('/') ? mapState(await tableOf(material, table)) : table
}

export function mapState({ sidecar, arrays }: LoadedMap): object {
  const { format, version, kind, quantity, symbol, constants } = sidecar
  // Of the maps of a height field a file may have but some.
  const recipe = { ...sidecar.recipe, methods: null }
  const contents = Object.entries(arrays).map(([name, { spec, data }]) => {
    const { dtype, shape, axes, channels, decode } = spec
    const digest = createHash('sha256').update(new Uint8Array(data.buffer)).digest('hex')
    return { name, dtype, shape, axes, channels, decode, digest }
  })
  contents.sort((a, b) => (a.name < b.name ? -1 : 1))
  return { format, version, kind, quantity, symbol, constants, recipe, contents }
}
