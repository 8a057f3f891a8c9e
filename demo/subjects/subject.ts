import type { Object3D, Vector2 } from 'three'
import type { DiffractionMaterial, Foil, Grating, HeightField } from '../../web'
import type { FlashPlace } from '../light/flash'
import type { Sheet } from './sheet'

/** One thing to look at, and how it is first seen. */
export interface Subject {
  /** One sentence about it. */
  caption: string
  object: Object3D
  material: DiffractionMaterial
  /** The last surface that could be shown. */
  surface: Foil | Grating | HeightField
  /** Where the camera stands at first. */
  camera: [number, number, number]
  /** Width over height of what is to stay in view. */
  aspect: number
  /** The object's first turn about x and y, rad. */
  tilt: [number, number]
  flash: FlashPlace
  /** Flash and exposure for what reflects less than metal: radiant intensity in the scene's units, EV. */
  light?: { flash: number; exposure: number }
  /** How many tiles of a foil, of 25 mm in most, cover it along u and v, where any foil can. */
  repeat?: Vector2
  /** What can be bent, where something can. */
  sheet?: Sheet
}

/** Addresses of the maps, as the page's server offers them. */
export const MAPS = `${import.meta.env.BASE_URL}maps/baked/`
