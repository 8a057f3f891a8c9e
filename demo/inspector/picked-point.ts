import {
  DoubleSide,
  InstancedMesh,
  Matrix3,
  Matrix4,
  Mesh,
  Raycaster,
  Triangle,
  Vector2,
  Vector3,
  type BufferGeometry,
  type Camera,
  type Intersection,
  type Material,
  type Object3D,
} from 'three'

/** A place on a mesh, that stays there however the mesh is moved or bent. */
export interface PickedPoint {
  mesh: Mesh<BufferGeometry, Material>
  instance: number
  /** The three vertices of its triangle, and how much each counts. */
  vertices: readonly [number, number, number]
  weights: Vector3
  /** Texture coordinates. */
  uv: Vector2
}

/** Where a point lies, and its surface's frame, in the world's axes. */
export interface PointFrame {
  position: Vector3
  /** Towards growing u, within the surface; towards growing v; outwards. Orthonormal. */
  tangent: Vector3
  bitangent: Vector3
  normal: Vector3
}

/**
 * What of the material is seen at a place of the view; null where it is not, or lies behind another part of the object.
 *
 * @param place - from −1 to 1 across and up
 */
export function pickAt(
  place: Vector2,
  camera: Camera,
  object: Object3D,
  material: Material,
): PickedPoint | null {
  const caster = new Raycaster()
  caster.setFromCamera(place, camera)
  const hit = caster.intersectObject(object, true)[0]
  if (!(hit?.object instanceof Mesh) || hit.object.material !== material) return null
  return pickedPoint(hit)
}

function pickedPoint({ object, face, point, uv, instanceId }: Intersection): PickedPoint {
  const mesh = object as unknown as PickedPoint['mesh']
  const vertices = [face!.a, face!.b, face!.c] as const
  const local = point.clone().applyMatrix4(worldMatrix(mesh, instanceId ?? 0).invert())
  const weights = new Vector3()
  Triangle.getBarycoord(local, ...corners(mesh, vertices), weights)
  return {
    ...{ mesh, instance: instanceId ?? 0, vertices, weights },
    uv: uv!.clone(),
  }
}

/** The point of a mesh that has these texture coordinates, in the same instance as another; null where none has. */
export function pointAtUv(near: PickedPoint, uv: Vector2): PickedPoint | null {
  const { mesh, instance } = near
  const { index } = mesh.geometry
  const count = index?.count ?? mesh.geometry.getAttribute('position').count
  const target = new Vector3(uv.x, uv.y, 0)
  const weights = new Vector3()
  for (let i = 0; i + 2 < count; i += 3) {
    const vertices = [0, 1, 2].map((k) => index?.getX(i + k) ?? i + k) as [number, number, number]
    const [a, b, c] = cornersUv(mesh, vertices).map(({ x, y }) => new Vector3(x, y, 0))
    if (Triangle.getBarycoord(target, a!, b!, c!, weights) === null) continue
    if (Math.min(...weights.toArray()) < -1e-6) continue
    return { mesh, instance, vertices, weights: weights.clone(), uv: uv.clone() }
  }
  return null
}

/**
 * Place and frame of a point now. As in shaders/tangent-frame.glsl the normal is on the viewer's side, and on the back of a
 * surface tangent and bitangent turn round.
 *
 * @param eye - where the camera is
 */
export function frameOf(point: PickedPoint, eye: Vector3): PointFrame {
  const { mesh, instance, vertices, weights } = point
  const world = worldMatrix(mesh, instance)
  const [a, b, c] = corners(mesh, vertices)
  for (const corner of [a, b, c]) corner.applyMatrix4(world)
  const position = blended([a, b, c], weights)
  const normals = mesh.geometry.getAttribute('normal')
  const normal = blended(
    vertices.map((vertex) => new Vector3().fromBufferAttribute(normals, vertex)),
    weights,
  )
    .applyMatrix3(new Matrix3().getNormalMatrix(world))
    .normalize()
  const [uvA, uvB, uvC] = cornersUv(mesh, vertices)
  const [e1, e2] = [b.sub(a), c.sub(a)]
  const [d1, d2] = [uvB.sub(uvA), uvC.sub(uvA)]
  const sign = Math.sign(d1.x * d2.y - d2.x * d1.y)
  const alongU = e1.clone().multiplyScalar(d2.y).addScaledVector(e2, -d1.y).multiplyScalar(sign)
  const alongV = e2.clone().multiplyScalar(d1.x).addScaledVector(e1, -d2.x).multiplyScalar(sign)
  const tangent = alongU.addScaledVector(normal, -alongU.dot(normal)).normalize()
  const bitangent = new Vector3().crossVectors(normal, tangent)
  if (bitangent.dot(alongV) < 0) bitangent.negate()
  const isBehind = eye.clone().sub(position).dot(e1.cross(e2)) < 0
  if (isBehind && mesh.material.side === DoubleSide)
    for (const axis of [tangent, bitangent, normal]) axis.negate()
  return { position, tangent, bitangent, normal }
}

function worldMatrix(mesh: Mesh, instance: number): Matrix4 {
  mesh.updateWorldMatrix(true, false)
  const world = mesh.matrixWorld.clone()
  if (!(mesh instanceof InstancedMesh)) return world
  const own = new Matrix4()
  mesh.getMatrixAt(instance, own)
  return world.multiply(own)
}

function corners(
  { geometry }: Mesh,
  vertices: readonly [number, number, number],
): [Vector3, Vector3, Vector3] {
  const position = geometry.getAttribute('position')
  return vertices.map((vertex) => new Vector3().fromBufferAttribute(position, vertex)) as [
    Vector3,
    Vector3,
    Vector3,
  ]
}

function cornersUv(
  { geometry }: Mesh,
  vertices: readonly [number, number, number],
): [Vector2, Vector2, Vector2] {
  const uv = geometry.getAttribute('uv')
  return vertices.map((vertex) => new Vector2(uv.getX(vertex), uv.getY(vertex))) as [
    Vector2,
    Vector2,
    Vector2,
  ]
}

function blended(ends: readonly Vector3[], weights: Vector3): Vector3 {
  const sum = new Vector3()
  ends.forEach((end, k) => sum.addScaledVector(end, weights.getComponent(k)))
  return sum
}
