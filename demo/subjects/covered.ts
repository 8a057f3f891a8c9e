import type { Vector2 } from 'three'
import { DiffractionMaterial, type DiffractionMaterialOptions } from '../../web'
import { foilAddress, loadFoil } from './foils'
import { MAPS, type Subject } from './subject'

/**
 * What covers an object with a foil that comes with the page: its material, ready to be drawn.
 *
 * @param repeat - tiles along u and v
 */
export async function covered(
  name: string,
  repeat: Vector2,
  settings: Omit<DiffractionMaterialOptions, 'surface' | 'mapsPath'>,
): Promise<Pick<Subject, 'material' | 'surface' | 'repeat'>> {
  const surface = await loadFoil(foilAddress(name), repeat)
  const material = new DiffractionMaterial({ surface, mapsPath: MAPS, ...settings })
  await material.ready
  return { material, surface, repeat }
}
