import {
  AdditiveBlending,
  CylinderGeometry,
  DoubleSide,
  Group,
  MathUtils,
  Mesh,
  MeshStandardMaterial,
  RingGeometry,
} from 'three'
import { DiffractionMaterial, Grating } from '../../web'
import { backOf } from './back'
import { MAPS, type Subject } from './subject'

/** Radii of a compact disc, in units of its outermost track's 58 mm: hole, first track, rim; and its thickness. */
const HOLE = 7.5 / 58
const FIRST_TRACK = 23 / 58
const RIM = 60 / 58
const THICKNESS = 1.2 / 58

/** A compact disc: circular tracks under clear polycarbonate. */
export async function disc(): Promise<Subject> {
  const surface = new Grating({
    period: 1.6,
    height: 0.12,
    profile: 'rectangular',
    tracks: 'circular',
  })
  const material = new DiffractionMaterial({
    surface,
    mapsPath: MAPS,
    roughness: MathUtils.degToRad(0.4),
    coat: 1,
    coatIor: 1.55,
  })
  await material.ready
  const tracks = new RingGeometry(FIRST_TRACK, 1, 256)
  // What is clear adds its reflections to what lies behind it.
  const clear = new MeshStandardMaterial({
    color: 0x050506,
    roughness: 0.04,
    blending: AdditiveBlending,
    transparent: true,
    side: DoubleSide,
    depthWrite: false,
  })
  const rim = new CylinderGeometry(RIM, RIM, THICKNESS, 256, 1, true)
  rim.rotateX(Math.PI / 2)
  const object = new Group()
  object.add(
    new Mesh(tracks, material),
    backOf(tracks),
    new Mesh(new RingGeometry(HOLE, FIRST_TRACK, 128), clear),
    new Mesh(new RingGeometry(1, RIM, 256), clear),
    new Mesh(rim, clear),
  )
  return {
    caption: 'A compact disc: tracks 1.6 µm apart in circles, under clear polycarbonate.',
    object,
    material,
    surface,
    camera: [0, 0.3, 4.4],
    aspect: 1.12,
    tilt: [MathUtils.degToRad(-28), MathUtils.degToRad(16)],
    flash: { azimuth: MathUtils.degToRad(-20), height: MathUtils.degToRad(48) },
  }
}
