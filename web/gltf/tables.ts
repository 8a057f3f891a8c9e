import { loadSharedMap } from '../maps/cache.ts'
import type { LoadedMap } from '../maps/load.ts'
import type { DiffractionMaterial } from '../materials/DiffractionMaterial.ts'

/** The map that a material has under that address. */
export async function tableOf({ maps }: DiffractionMaterial, address: string): Promise<LoadedMap> {
  return maps[address] ?? (await loadSharedMap(address))
}
