import {
  CatmullRomCurve3,
  DoubleSide,
  LatheGeometry,
  MathUtils,
  Mesh,
  Vector2,
  Vector3,
} from 'three'
import { DiffractionMaterial, Grating } from '../../web'
import { MAPS, type Subject } from './subject'

/** Radius and height along the outside, from the foot to the lip. */
const OUTLINE = [
  [0.26, -0.95],
  [0.3, -0.92],
  [0.44, -0.62],
  [0.56, -0.22],
  [0.5, 0.2],
  [0.3, 0.52],
  [0.2, 0.74],
  [0.24, 0.95],
] as const

function outline(): Vector2[] {
  const curve = new CatmullRomCurve3(OUTLINE.map(([radius, y]) => new Vector3(radius, y, 0)))
  return curve.getSpacedPoints(128).map(({ x, y }) => new Vector2(x, y))
}

/** A turned vase; its grooves run around it, as a lathe leaves them. */
export async function vase(): Promise<Subject> {
  const surface = new Grating({ period: 1.2, height: 0.14, orientation: Math.PI / 2 })
  const material = new DiffractionMaterial({
    surface,
    mapsPath: MAPS,
    roughness: MathUtils.degToRad(0.8),
    side: DoubleSide,
  })
  await material.ready
  const object = new Mesh(new LatheGeometry(outline(), 192), material)
  return {
    caption: 'A turned vase with fine grooves around it, as a lathe leaves them.',
    object,
    material,
    surface,
    camera: [0, 0.35, 4.6],
    aspect: 0.72,
    tilt: [0, 0],
    flash: { azimuth: MathUtils.degToRad(-40), height: MathUtils.degToRad(30) },
  }
}
