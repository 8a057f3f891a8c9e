import { Group, MathUtils, Vector2 } from 'three'
import { covered } from './covered'
import { roundedPlane } from './rounded-plane'
import { Sheet } from './sheet'
import type { Subject } from './subject'

/** As a bank card, 85.6 mm × 54 mm with corners of 3.2 mm. */
const [WIDTH, HEIGHT, CORNER] = [1.8, 1.135, 0.067]
/** Tiles of 25 mm: with them the card has about the size of a bank card. */
const REPEAT = new Vector2(3, 1.9)

/** A gently bent card covered with a holographic foil. */
export async function card(): Promise<Subject> {
  const cover = await covered('polygons', REPEAT, {
    roughness: MathUtils.degToRad(0.7),
    color: 0x74757a,
  })
  const sheet = new Sheet(WIDTH)
  sheet.add(roundedPlane(WIDTH, HEIGHT, CORNER), cover.material, true)
  sheet.angle = MathUtils.degToRad(24)
  return {
    caption: 'A holographic foil: each place is a grating, turned its own way. Tilt it.',
    object: new Group().add(...sheet.meshes),
    ...cover,
    camera: [0, 0.2, 3.45],
    aspect: 1.28,
    tilt: [MathUtils.degToRad(-14), MathUtils.degToRad(-18)],
    flash: { azimuth: MathUtils.degToRad(38), height: MathUtils.degToRad(25) },
    sheet,
  }
}
