import type { Object3D } from 'three'
import type { DiffractionMaterial, Foil, Grating } from '../../web'
import type { FlashPlace } from '../light/flash'

/** One thing to look at, and how it is first seen. */
export interface Subject {
  /** One sentence about it. */
  caption: string
  object: Object3D
  material: DiffractionMaterial
  surface: Foil | Grating
  /** Where the camera stands at first. */
  camera: [number, number, number]
  /** Width over height of what is to stay in view. */
  aspect: number
  /** The object's first turn about x and y, rad. */
  tilt: [number, number]
  flash: FlashPlace
  /** How the shape can be bent, where it can. */
  bend?: { get: () => number; set: (radians: number) => void }
}

/** Addresses of the maps, as the page's server offers them. */
export const MAPS = '/maps/baked/'
