import { Group, MathUtils, Mesh, Shape, ShapeGeometry } from 'three'
import { DiffractionMaterial, HeightField } from '../../web'
import { backOf } from './back'
import { MAPS, type Subject } from './subject'

/** Half the angle that a wafer's straight edge spans, rad; it shows how the wafer is turned. */
const FLAT = MathUtils.degToRad(18)

/** A flat metallised wafer with the same relief all over. */
export async function wafer(): Promise<Subject> {
  const surface = new HeightField({ field: 'bumps' })
  const material = new DiffractionMaterial({
    surface,
    mapsPath: MAPS,
    roughness: MathUtils.degToRad(0.5),
  })
  await material.ready
  const outline = new Shape().absarc(0, 0, 0.9, FLAT - Math.PI / 2, 1.5 * Math.PI - FLAT)
  const geometry = new ShapeGeometry(outline, 96)
  const object = new Group()
  object.add(new Mesh(geometry, material), backOf(geometry))
  return {
    caption: 'A flat, metallised sample of a relief that repeats all over it. Choose another one.',
    object,
    material,
    surface,
    camera: [0, 0.2, 4],
    aspect: 1.1,
    tilt: [MathUtils.degToRad(-24), MathUtils.degToRad(-16)],
    flash: { azimuth: MathUtils.degToRad(-44), height: MathUtils.degToRad(44) },
  }
}
