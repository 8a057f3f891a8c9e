import { Vector2, Vector3, type BufferAttribute, type BufferGeometry } from 'three'

/** The one frame of a flat geometry, in the object's own axes. */
export interface FlatFrame {
  /** Unit normal of every vertex, and of every triangle as it is wound. */
  normal: Vector3
  /** Unit vector towards growing u. */
  tangent: Vector3
  /** 1 where v grows towards cross(normal, tangent), −1 where uv are mirrored. */
  handedness: 1 | -1
  /** A point of the plane. */
  point: Vector3
}

interface Checked {
  frame: FlatFrame | null
  /** Attributes, index and their versions when it was checked. */
  sources: unknown[]
}

/** Normals and tangents that agree to this angle, rad, are the same: what 16-bit attributes can hold, and no curvature. */
const TOLERANCE = 1e-4

const checkedGeometries = new WeakMap<BufferGeometry, Checked>()

/**
 * The frame of a geometry that lies in one plane with uv that run straight over it; null if it does not. Looked at
 * once for each version of its attributes.
 */
export function flatFrame(geometry: BufferGeometry): FlatFrame | null {
  const sources = sourcesOf(geometry)
  const known = checkedGeometries.get(geometry)
  if (known?.sources.every((source, i) => source === sources[i])) return known.frame
  const frame = findFrame(geometry)
  checkedGeometries.set(geometry, { frame, sources })
  return frame
}

function sourcesOf({ attributes, index }: BufferGeometry): unknown[] {
  const { position, normal, uv, tangent } = attributes
  return [position, normal, uv, tangent, index].flatMap((attribute) => [
    attribute,
    attribute && ('data' in attribute ? attribute.data.version : attribute.version),
  ])
}

function findFrame(geometry: BufferGeometry): FlatFrame | null {
  const { position, normal, uv, tangent } = geometry.attributes as Partial<
    Record<string, BufferAttribute>
  >
  if (!position || !normal || !uv) return null
  const frame: FlatFrame = {
    normal: new Vector3().fromBufferAttribute(normal, 0),
    tangent: new Vector3(),
    handedness: 1,
    point: new Vector3().fromBufferAttribute(position, 0),
  }
  if (!isUnit(frame.normal)) return null
  for (let i = 1; i < normal.count; i++)
    if (!agree(vertex.fromBufferAttribute(normal, i), frame.normal)) return null
  if (!takeTriangles(geometry, position, uv, frame)) return null
  return tangent && !takeTangents(tangent, frame) ? null : frame
}

const vertex = new Vector3()
const corners = [new Vector3(), new Vector3(), new Vector3()] as const
const uvs = [new Vector2(), new Vector2(), new Vector2()] as const
const across = new Vector3()
const alongU = new Vector3()

/** Finds tangent and handedness; false where triangles differ, do not face along the normal, or have no tangent. */
function takeTriangles(
  { index }: BufferGeometry,
  position: BufferAttribute,
  uv: BufferAttribute,
  frame: FlatFrame,
): boolean {
  const count = index?.count ?? position.count
  let found = false
  for (let first = 0; first + 2 < count; first += 3) {
    for (const k of [0, 1, 2] as const) {
      const i = index?.getX(first + k) ?? first + k
      corners[k].fromBufferAttribute(position, i)
      uvs[k].fromBufferAttribute(uv, i)
    }
    const [p, q, r] = corners
    const [a, b, c] = uvs
    q.sub(p)
    r.sub(p)
    across.crossVectors(q, r)
    const length = across.length()
    // Covers no pixel. Where two corners coincide, rounding leaves some 1e-7 of the squares of the other sides.
    if (length <= 1e-6 * Math.max(q.lengthSq(), r.lengthSq())) continue
    if (!agree(across.divideScalar(length), frame.normal)) return false
    const offset = p.sub(frame.point).dot(frame.normal)
    if (Math.abs(offset) > TOLERANCE * Math.sqrt(Math.max(p.lengthSq(), length))) return false
    b.sub(a)
    c.sub(a)
    const area = b.cross(c)
    alongU.copy(q).multiplyScalar(c.y).addScaledVector(r, -b.y)
    if (area === 0 || !isFinite(area) || alongU.lengthSq() === 0) return false
    alongU.multiplyScalar(Math.sign(area)).normalize()
    const handedness = area > 0 ? 1 : -1
    if (!found) {
      frame.tangent.copy(alongU)
      frame.handedness = handedness
      found = true
    } else if (handedness !== frame.handedness || !agree(alongU, frame.tangent)) return false
  }
  return found
}

/** Attributes come before uv, as in the shader; false where they differ. */
function takeTangents(tangents: BufferAttribute, frame: FlatFrame): boolean {
  frame.tangent.fromBufferAttribute(tangents, 0)
  if (!isUnit(frame.tangent)) return false
  frame.handedness = tangents.getW(0) < 0 ? -1 : 1
  for (let i = 1; i < tangents.count; i++) {
    if (!agree(vertex.fromBufferAttribute(tangents, i), frame.tangent)) return false
    if ((tangents.getW(i) < 0 ? -1 : 1) !== frame.handedness) return false
  }
  return true
}

/** Not "> TOLERANCE": a NaN must fail it too. */
function agree(a: Vector3, b: Vector3): boolean {
  return a.distanceToSquared(b) <= TOLERANCE * TOLERANCE
}

function isUnit(a: Vector3): boolean {
  return Math.abs(a.lengthSq() - 1) <= 2 * TOLERANCE
}
