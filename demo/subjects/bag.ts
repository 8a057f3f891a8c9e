import {
  CatmullRomCurve3,
  DoubleSide,
  Group,
  MathUtils,
  Mesh,
  MeshStandardMaterial,
  PlaneGeometry,
  TubeGeometry,
  Vector2,
  Vector3,
  type BufferGeometry,
} from 'three'
import { mergeGeometries } from 'three/addons/utils/BufferGeometryUtils.js'
import { backOf } from './back'
import { covered } from './covered'
import type { Subject } from './subject'

const [WIDTH, HEIGHT, DEPTH] = [0.96, 1.44, 0.42]
/** How far the sides are folded in at the top, and front and back bulge in their middle. */
const FOLD = 0.16
const BULGE = 0.045
const PAPER = 0x9c1424
const REPEAT = new Vector2(2, 3)

/** A gift bag: paper with a hot-stamped foil on front and back. */
export async function bag(): Promise<Subject> {
  const cover = await covered('logo', REPEAT, {
    roughness: MathUtils.degToRad(0.9),
    color: PAPER,
  })
  const paper = new MeshStandardMaterial({ color: PAPER, roughness: 0.75, side: DoubleSide })
  const cord = new MeshStandardMaterial({ color: 0xe8dcc0, roughness: 0.9 })
  const faces = mergeGeometries([face(), face().rotateY(Math.PI)])
  const object = new Group()
  object.add(
    new Mesh(faces, cover.material),
    backOf(faces),
    new Mesh(mergeGeometries([side(), side().rotateY(Math.PI), floor()]), paper),
    new Mesh(handle(DEPTH / 2), cord),
    new Mesh(handle(-DEPTH / 2), cord),
  )
  return {
    caption: 'A gift bag: paper, hot-stamped with a foil on front and back.',
    object,
    ...cover,
    camera: [0.5, 0.35, 5],
    aspect: 0.8,
    tilt: [MathUtils.degToRad(2), MathUtils.degToRad(-24)],
    flash: { azimuth: MathUtils.degToRad(28), height: MathUtils.degToRad(38) },
  }
}

/** The front, bulging a little; its edges are where those of the sides are. */
function face(): BufferGeometry {
  const geometry = new PlaneGeometry(WIDTH, HEIGHT, 24, 32)
  const position = geometry.getAttribute('position')
  for (let i = 0; i < position.count; i++) {
    const across = Math.cos((Math.PI * position.getX(i)) / WIDTH)
    const along = Math.cos((Math.PI * position.getY(i)) / HEIGHT)
    position.setZ(i, DEPTH / 2 + BULGE * across * along)
  }
  geometry.computeVertexNormals()
  return geometry
}

/** The right side: two halves that meet in a crease, which goes inwards towards the top. */
function side(): BufferGeometry {
  const geometry = new PlaneGeometry(DEPTH, HEIGHT, 2, 1).rotateY(Math.PI / 2)
  const position = geometry.getAttribute('position')
  for (let i = 0; i < position.count; i++) {
    const isCrease = Math.abs(position.getZ(i)) < 1e-6
    const isTop = position.getY(i) > 0
    position.setX(i, WIDTH / 2 - (isCrease && isTop ? FOLD : 0))
  }
  const creased = geometry.toNonIndexed()
  creased.computeVertexNormals()
  return creased
}

function floor(): BufferGeometry {
  return new PlaneGeometry(WIDTH, DEPTH)
    .rotateX(Math.PI / 2)
    .translate(0, -HEIGHT / 2, 0)
    .toNonIndexed()
}

/** A cord that hangs in two holes near the rim. */
function handle(z: number): BufferGeometry {
  const points = [
    [-0.2, 0.65],
    [-0.2, 0.76],
    [-0.17, 0.95],
    [0, 1.03],
    [0.17, 0.95],
    [0.2, 0.76],
    [0.2, 0.65],
  ] as const
  const out = Math.sign(z) * 0.025
  const curve = new CatmullRomCurve3(points.map(([x, y]) => new Vector3(x, y, z + out)))
  return new TubeGeometry(curve, 64, 0.014, 10)
}
