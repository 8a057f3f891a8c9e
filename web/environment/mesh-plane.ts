import {
  BackSide,
  DoubleSide,
  Matrix3,
  Matrix4,
  Vector3,
  type BufferGeometry,
  type Camera,
  type Object3D,
  type Side,
} from 'three'
import { flatFrame } from './flat-geometry.ts'

/** Kinds of object whose vertices move on the GPU. */
type MovedObject = Object3D & {
  isSkinnedMesh?: boolean
  isInstancedMesh?: boolean
  isBatchedMesh?: boolean
}

const normalMatrix = new Matrix3()
const normal = new Vector3()
const tangent = new Vector3()
const bitangent = new Vector3()
const towardsViewer = new Vector3()
const inWorld = new Vector3()

/**
 * The frame that shaders/tangent-frame.glsl finds at every pixel of a flat mesh, in the world: tangent, bitangent and
 * normal, orthonormal, on the side that is seen.
 *
 * @param target - takes them as its columns
 * @returns false if the mesh is not flat, or a vertex stage may bend it
 */
export function meshPlane(
  object: MovedObject,
  geometry: BufferGeometry,
  side: Side,
  camera: Camera,
  target: Matrix3,
): boolean {
  if (object.isSkinnedMesh || object.isInstancedMesh || object.isBatchedMesh) return false
  if (Object.keys(geometry.morphAttributes).length > 0) return false
  const frame = flatFrame(geometry)
  if (frame === null) return false
  const { matrixWorld } = object
  normal.copy(frame.normal).applyMatrix3(normalMatrix.getNormalMatrix(matrixWorld)).normalize()
  tangent.copy(frame.tangent).transformDirection(matrixWorld)
  tangent.addScaledVector(normal, -tangent.dot(normal)).normalize()
  // A mirroring transform turns a cross product round.
  const handedness = frame.handedness * Math.sign(matrixWorld.determinant())
  bitangent.crossVectors(normal, tangent).multiplyScalar(handedness)
  const isBack =
    side === BackSide || (side === DoubleSide && !facesViewer(frame.point, matrixWorld, camera))
  target.set(
    ...([tangent.x, bitangent.x, normal.x] as const),
    ...([tangent.y, bitangent.y, normal.y] as const),
    ...([tangent.z, bitangent.z, normal.z] as const),
  )
  if (isBack) target.multiplyScalar(-1)
  // A scale of zero leaves no plane.
  return target.elements.every(Number.isFinite) && Math.abs(target.determinant()) > 0.5
}

/** Whether the camera is on the side to which `normal` points. */
function facesViewer(point: Vector3, matrixWorld: Matrix4, camera: Camera): boolean {
  const isOrthographic = camera.projectionMatrix.elements[11] === 0
  if (isOrthographic) towardsViewer.setFromMatrixColumn(camera.matrixWorld, 2)
  else {
    towardsViewer.setFromMatrixPosition(camera.matrixWorld)
    towardsViewer.sub(inWorld.copy(point).applyMatrix4(matrixWorld))
  }
  return towardsViewer.dot(normal) > 0
}
