import { Group, MathUtils, Mesh, PlaneGeometry, Vector2 } from 'three'
import { DiffractionMaterial, Foil } from '../../web'
import { backOf } from './back'
import { bendPlane } from './bent-plane'
import { MAPS, type Subject } from './subject'

/** The foils that come with the page, by the addresses of their maps; none of them, where another address was given. */
export const FOILS: Readonly<Record<string, string>> = {
  [`${MAPS}foil-polygons`]: 'Polygons',
  [`${MAPS}foil-glitter`]: 'Glitter',
  [`${MAPS}foil-kinematic-discs`]: 'Kinematic discs',
  [`${MAPS}foil-gradient-stars`]: 'Gradient stars',
  [`${MAPS}foil-fireworks`]: 'Fireworks',
  [`${MAPS}foil-emblem`]: 'Emblem',
  [`${MAPS}foil-logo`]: 'Logo',
  '': 'By its address',
}
export const FOIL_MAP = `${MAPS}foil-polygons`
/** Tiles of 25 mm: with them the card has about the size of a credit card. */
const REPEAT = new Vector2(3, 2)

/** A foil's map, tiled over the card. */
export function loadFoil(url: string): Promise<Foil> {
  return Foil.load(url, { repeat: REPEAT })
}

/** A gently bent card covered with a holographic foil. */
export async function foilCard(): Promise<Subject> {
  const surface = await loadFoil(FOIL_MAP)
  const material = new DiffractionMaterial({
    surface,
    mapsPath: MAPS,
    roughness: MathUtils.degToRad(0.7),
    color: 0x74757a,
  })
  await material.ready
  const geometry = new PlaneGeometry(1.8, 1.2, 96, 1)
  let bend = MathUtils.degToRad(24)
  bendPlane(geometry, bend)
  const object = new Group()
  object.add(new Mesh(geometry, material), backOf(geometry))
  return {
    caption: 'A holographic foil: each place is a grating, turned its own way. Tilt it.',
    object,
    material,
    surface,
    camera: [0, 0.2, 3.45],
    aspect: 1.28,
    tilt: [MathUtils.degToRad(-14), MathUtils.degToRad(-18)],
    flash: { azimuth: MathUtils.degToRad(38), height: MathUtils.degToRad(25) },
    bend: {
      get: () => bend,
      set: (radians) => {
        bend = radians
        bendPlane(geometry, bend)
      },
    },
  }
}
