import { Color, InstancedMesh, MathUtils, Matrix4, Vector3, type Material } from 'three'
import { LENGTH, radiusAt, pointAt } from './body'
import { scaleGeometry } from './scale'

/** Scales around the body. Those of the next row lie between them. */
const COLUMNS = 18
/** Distance between rows, in radii of the body. */
const ROW = 0.3
/** A scale is so much larger than its share of the skin. */
const OVERLAP = 1.2
/** The snout's foremost scales, as a share of the length; nearer to its tip they would be too small to be seen. */
const FIRST_ROW = 0.002
/** How far scales are turned in the skin, rad, either way. */
const TURN = MathUtils.degToRad(4)

const BACK = new Color(0x1b1410)
const BELLY = new Color(0x8f7f66)

/** All scales of the body, in staggered rows, each a little askew. */
export function scales(material: Material): InstancedMesh {
  const geometry = scaleGeometry({
    size: [OVERLAP * ROW, (OVERLAP * Math.PI) / COLUMNS],
    lift: 0.05,
    dome: 0.25,
  })
  const places = rows().flatMap((distance, row) =>
    Array.from({ length: COLUMNS }, (_, column) => ({
      distance,
      angle: ((column + (row % 2) / 2) * 2 * Math.PI) / COLUMNS,
    })),
  )
  const mesh = new InstancedMesh(geometry, material, places.length)
  const turn = new Matrix4()
  const color = new Color()
  for (const [i, { distance, angle }] of places.entries()) {
    const askew = TURN * (2 * MathUtils.seededRandom(i + 1) - 1)
    mesh.setMatrixAt(i, frameAt(distance, angle).multiply(turn.makeRotationZ(askew)))
    mesh.setColorAt(i, color.lerpColors(BACK, BELLY, MathUtils.smoothstep(-Math.cos(angle), 0, 1)))
  }
  return mesh
}

/** Distances of the rows from the snout: scales are as large as the body is thick. */
function rows(): number[] {
  const distances: number[] = []
  for (let at = FIRST_ROW * LENGTH; at < LENGTH;) {
    distances.push(at)
    at += ROW * Math.max(radiusAt(at), 0.01)
  }
  return distances
}

/** Axes of a scale in the body's skin, as long as the body's radius there; those of a bend's inside are shorter. */
function frameAt(distance: number, angle: number): Matrix4 {
  const step = 1e-4 * LENGTH
  const radius = radiusAt(distance)
  const along = pointAt(distance + step, angle).sub(pointAt(distance - step, angle))
  const around = pointAt(distance, angle + 0.01).sub(pointAt(distance, angle - 0.01))
  const outward = new Vector3().crossVectors(along, around).setLength(radius)
  along.multiplyScalar(radius / (2 * step))
  around.setLength(radius)
  return new Matrix4().makeBasis(along, around, outward).setPosition(pointAt(distance, angle))
}
