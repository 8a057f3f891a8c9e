import { Group, MathUtils, MeshStandardMaterial, PlaneGeometry, Vector2 } from 'three'
import { covered } from '../covered'
import { Sheet } from '../sheet'
import type { Subject } from '../subject'
import { notePrint } from './print'

const [WIDTH, HEIGHT] = [2, 0.91]
/** The foil: a strip from edge to edge, stuck on the paper. */
const STRIP = { x: 0.66, width: 0.3 }
const STUCK = 0.0015
const REPEAT = new Vector2(1, HEIGHT / STRIP.width)

/** A note as a bank might issue it, with a strip of foil. */
export async function note(): Promise<Subject> {
  const cover = await covered('kinematic-discs', REPEAT, {
    roughness: MathUtils.degToRad(0.7),
    color: 0x9a9c9c,
  })
  const paper = new MeshStandardMaterial({ map: notePrint(), roughness: 0.85 })
  const strip = new PlaneGeometry(STRIP.width, HEIGHT, 24, 1)
  const sheet = new Sheet(WIDTH)
  sheet.add(new PlaneGeometry(WIDTH, HEIGHT, 96, 1), paper, true)
  sheet.add(strip.translate(STRIP.x, 0, STUCK), cover.material)
  sheet.angle = MathUtils.degToRad(38)
  return {
    caption: 'A note as a bank might issue it: engraved paper with a strip of moving discs.',
    object: new Group().add(...sheet.meshes),
    ...cover,
    camera: [0, 0.2, 3.3],
    aspect: 1.5,
    tilt: [MathUtils.degToRad(-16), MathUtils.degToRad(-14)],
    flash: { azimuth: MathUtils.degToRad(34), height: MathUtils.degToRad(30) },
    sheet,
  }
}
