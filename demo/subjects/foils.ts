import type { Vector2 } from 'three'
import { Foil } from '../../web'
import { MAPS } from './subject'

/** The foils that come with the page, by the addresses of their maps; none of them, where another address was given. */
export const FOILS: Readonly<Record<string, string>> = {
  [foilAddress('polygons')]: 'Polygons',
  [foilAddress('stars')]: 'Stars',
  [foilAddress('circles')]: 'Circles',
  [foilAddress('periods')]: 'Varying periods',
  [foilAddress('spiral')]: 'Spiral',
  [foilAddress('glitter')]: 'Glitter',
  [foilAddress('kinematic-discs')]: 'Kinematic discs',
  [foilAddress('gradient-stars')]: 'Gradient stars',
  [foilAddress('fireworks')]: 'Fireworks',
  [foilAddress('emblem')]: 'Emblem',
  [foilAddress('logo')]: 'Logo',
  [foilAddress('disc')]: 'Disc',
  '': 'By its address',
}

/** Address of the map of a foil that comes with the page. */
export function foilAddress(name: string): string {
  return `${MAPS}foil-${name}`
}

/** A foil's map, tiled as the object that it covers asks for. */
export function loadFoil(url: string, repeat: Vector2): Promise<Foil> {
  return Foil.load(url, { repeat })
}
