import {
  BackSide,
  BoxGeometry,
  BufferGeometry,
  CircleGeometry,
  DoubleSide,
  Float32BufferAttribute,
  FrontSide,
  InstancedMesh,
  Matrix3,
  Mesh,
  OrthographicCamera,
  PerspectiveCamera,
  PlaneGeometry,
  SphereGeometry,
  Vector3,
  type Camera,
  type Side,
} from 'three'
import { describe, expect, it } from 'vitest'
import { flatFrame } from '../../web/environment/flat-geometry'
import { meshPlane } from '../../web/environment/mesh-plane'

/** A plane whose attributes are changed at one vertex. */
function bent(
  name: 'position' | 'normal' | 'uv',
  component: 'setX' | 'setY' | 'setZ',
): BufferGeometry {
  const geometry = new PlaneGeometry(2, 2, 3, 3)
  geometry.getAttribute(name)[component](5, 0.4)
  return geometry
}

function mirrored(): BufferGeometry {
  const geometry = new PlaneGeometry(2, 2, 3, 3)
  const uv = geometry.getAttribute('uv')
  for (let i = 0; i < uv.count; i++) uv.setX(i, 1 - uv.getX(i))
  return geometry
}

function expectVector(actual: Vector3, expected: [number, number, number]): void {
  expect(actual.distanceTo(new Vector3(...expected))).toBeLessThan(1e-6)
}

describe('flatFrame', () => {
  it.each<[string, BufferGeometry]>([
    ['a plane', new PlaneGeometry(3, 2, 4, 5)],
    ['a disc', new CircleGeometry(1, 40)],
    ['triangles without an index', new PlaneGeometry(1, 1).toNonIndexed()],
    ['a plane far away', new PlaneGeometry(1, 1).translate(1e3, 0, 1e3)],
  ])('finds the frame of %s', (_name, geometry) => {
    const frame = flatFrame(geometry)!
    expectVector(frame.normal, [0, 0, 1])
    expectVector(frame.tangent, [1, 0, 0])
    expect(frame.handedness).toBe(1)
  })

  it('finds mirrored uv, with and without tangents', () => {
    const geometry = mirrored()
    expectVector(flatFrame(geometry)!.tangent, [-1, 0, 0])
    expect(flatFrame(geometry)!.handedness).toBe(-1)
    geometry.computeTangents()
    expectVector(flatFrame(geometry)!.tangent, [-1, 0, 0])
    expect(flatFrame(geometry)!.handedness).toBe(-1)
  })

  it.each<[string, BufferGeometry]>([
    ['a sphere', new SphereGeometry(1)],
    ['a box', new BoxGeometry()],
    ['a raised vertex', bent('position', 'setZ')],
    ['a tilted normal', bent('normal', 'setX')],
    ['bent uv', bent('uv', 'setY')],
    ['a plane that is wound against its normals', new PlaneGeometry(1, 1).scale(1, -1, 1)],
    ['a geometry without uv', new PlaneGeometry(1, 1).deleteAttribute('uv')],
    ['nothing', new BufferGeometry()],
  ])('finds none of %s', (_name, geometry) => {
    expect(flatFrame(geometry)).toBeNull()
  })

  it('finds none where a NaN is', () => {
    const geometry = new PlaneGeometry(1, 1)
    geometry.getAttribute('position').setX(2, NaN)
    expect(flatFrame(geometry)).toBeNull()
  })

  it('looks again when an attribute changes, or is another', () => {
    const geometry = new PlaneGeometry(1, 1)
    const frame = flatFrame(geometry)
    expect(frame).not.toBeNull()
    expect(flatFrame(geometry)).toBe(frame)
    const position = geometry.getAttribute('position')
    position.setZ(0, 1)
    position.needsUpdate = true
    expect(flatFrame(geometry)).toBeNull()
    geometry.setAttribute('position', new PlaneGeometry(1, 1).getAttribute('position'))
    expect(flatFrame(geometry)).not.toBeNull()
  })
})

describe('meshPlane', () => {
  const front = new PerspectiveCamera()
  front.position.set(0.2, 0.1, 3)
  front.updateMatrixWorld()

  function planeOf(
    mesh: Mesh,
    side: Side = FrontSide,
    camera: Camera = front,
  ): { tangent: Vector3; bitangent: Vector3; normal: Vector3 } | null {
    mesh.updateMatrixWorld()
    const target = new Matrix3()
    if (!meshPlane(mesh, mesh.geometry, side, camera, target)) return null
    const [tangent, bitangent, normal] = [new Vector3(), new Vector3(), new Vector3()]
    target.extractBasis(tangent, bitangent, normal)
    return { tangent, bitangent, normal }
  }

  it('turns with the mesh', () => {
    const mesh = new Mesh(new PlaneGeometry(1, 1))
    mesh.rotation.set(Math.PI / 2, 0, 0)
    const plane = planeOf(mesh)!
    expectVector(plane.tangent, [1, 0, 0])
    expectVector(plane.bitangent, [0, 0, 1])
    expectVector(plane.normal, [0, -1, 0])
  })

  it('follows growing uv through mirrors and stretches', () => {
    const mesh = new Mesh(new PlaneGeometry(1, 1))
    mesh.scale.set(-2, 0.5, 1)
    const plane = planeOf(mesh)!
    expectVector(plane.tangent, [-1, 0, 0])
    expectVector(plane.bitangent, [0, 1, 0])
    expectVector(plane.normal, [0, 0, 1])
  })

  it('turns round where the back is seen', () => {
    const mesh = new Mesh(new PlaneGeometry(1, 1))
    const behind = new OrthographicCamera()
    behind.rotation.y = Math.PI
    behind.updateMatrixWorld()
    for (const plane of [planeOf(mesh, BackSide), planeOf(mesh, DoubleSide, behind)]) {
      expectVector(plane!.tangent, [-1, 0, 0])
      expectVector(plane!.bitangent, [0, -1, 0])
      expectVector(plane!.normal, [0, 0, -1])
    }
    expectVector(planeOf(mesh, DoubleSide)!.normal, [0, 0, 1])
  })

  it('is none of what vertex stages bend, nor of a mesh without size', () => {
    const morphed = new PlaneGeometry(1, 1)
    morphed.morphAttributes.position = [new Float32BufferAttribute(new Float32Array(12), 3)]
    expect(planeOf(new Mesh(morphed))).toBeNull()
    expect(planeOf(new InstancedMesh(new PlaneGeometry(1, 1), undefined, 1))).toBeNull()
    const flat = new Mesh(new PlaneGeometry(1, 1))
    flat.scale.set(0, 1, 1)
    expect(planeOf(flat)).toBeNull()
  })
})
