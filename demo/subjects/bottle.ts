import {
  CylinderGeometry,
  Group,
  LatheGeometry,
  MathUtils,
  Mesh,
  MeshPhysicalMaterial,
  Vector2,
  type BufferGeometry,
} from 'three'
import { mergeGeometries } from 'three/addons/utils/BufferGeometryUtils.js'
import { covered } from './covered'
import type { Subject } from './subject'

/** Radius of the body and of the neck; radius and height along the outside, from the foot to the lip. */
const [BODY, NECK] = [0.42, 0.15]
const OUTLINE = [
  [0, -1.1],
  [0.36, -1.1],
  [0.405, -1.085],
  [BODY, -1.04],
  [BODY, -0.6],
  [BODY, 0.12],
  [0.41, 0.24],
  [0.35, 0.4],
  [0.22, 0.56],
  [0.165, 0.68],
  [NECK, 0.8],
  [0.142, 1.05],
  [0.142, 1.2],
  [0, 1.2],
] as const
/** The paper is that much outside the glass. */
const PAPER = 0.004
/** Bounds of the label's height, and the angle that it spans, rad. */
const LABEL = { low: -0.86, high: -0.02, span: MathUtils.degToRad(200) }
/** Bounds of the capsule about the neck. */
const CAPSULE = { low: 0.76, high: 1.215 }
/** As wide as the label, and as high as it. */
const REPEAT = new Vector2(2, (2 * (LABEL.high - LABEL.low)) / (BODY * LABEL.span))

/** A bottle of dark glass with a foil label and a capsule of the same foil. */
export async function bottle(): Promise<Subject> {
  const cover = await covered('fireworks', REPEAT, {
    metal: 'gold',
    roughness: MathUtils.degToRad(1.2),
    color: 0x11151c,
  })
  const glass = new MeshPhysicalMaterial({ color: 0x06140b, roughness: 0.05, clearcoat: 1 })
  const outline = OUTLINE.map(([radius, y]) => new Vector2(radius, y))
  const object = new Group()
  object.add(
    new Mesh(new LatheGeometry(outline, 128), glass),
    new Mesh(mergeGeometries([label(), capsule()]), cover.material),
  )
  return {
    caption: 'A bottle: its label and the capsule about its neck are of one golden foil.',
    object,
    ...cover,
    camera: [0, 0.25, 6.1],
    aspect: 0.62,
    tilt: [MathUtils.degToRad(4), MathUtils.degToRad(14)],
    flash: { azimuth: MathUtils.degToRad(-30), height: MathUtils.degToRad(24) },
  }
}

function label(): BufferGeometry {
  const { low, high, span } = LABEL
  const radius = BODY + PAPER
  return new CylinderGeometry(radius, radius, high - low, 96, 1, true, -span / 2, span).translate(
    0,
    (low + high) / 2,
    0,
  )
}

/** uv as the label's: one tile is as large on both. */
function capsule(): BufferGeometry {
  const { low, high } = CAPSULE
  const radius = NECK + PAPER
  const geometry = new CylinderGeometry(radius, radius, high - low, 64, 1, true)
  const uv = geometry.getAttribute('uv')
  const [across, along] = [
    (2 * Math.PI * radius) / (BODY * LABEL.span),
    (high - low) / (LABEL.high - LABEL.low),
  ]
  for (let i = 0; i < uv.count; i++) uv.setXY(i, across * uv.getX(i), along * uv.getY(i))
  return geometry.translate(0, (low + high) / 2, 0)
}
