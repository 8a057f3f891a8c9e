import { PlaneGeometry } from 'three'

/** Columns of a corner: its outline is off the circle by a thousandth of the radius. */
const CORNER_STEPS = 12
/** Columns between the corners: enough for the plane to be bent. */
const MIDDLE_STEPS = 72

/** A plane with rounded corners, in columns that can be bent; uv as a PlaneGeometry has it. */
export function roundedPlane(width: number, height: number, radius: number): PlaneGeometry {
  const edges: number[] = []
  for (let i = 0; i <= CORNER_STEPS; i++)
    edges.push(radius * (1 - Math.cos((Math.PI / 2) * (i / CORNER_STEPS))))
  const middle = Array.from(
    { length: MIDDLE_STEPS - 1 },
    (_, i) => radius + ((i + 1) / MIDDLE_STEPS) * (width - 2 * radius),
  )
  const columns = [...edges, ...middle, ...edges.map((x) => width - x).reverse()]
  const geometry = new PlaneGeometry(width, height, columns.length - 1, 1)
  const position = geometry.getAttribute('position')
  const uv = geometry.getAttribute('uv')
  for (let i = 0; i < position.count; i++) {
    const x = columns[i % columns.length]!
    const inCorner = Math.max(radius - x, radius - (width - x), 0)
    const cut = radius - Math.sqrt(radius ** 2 - inCorner ** 2)
    const y = Math.sign(position.getY(i)) * (height / 2 - cut)
    position.setXY(i, x - width / 2, y)
    uv.setXY(i, x / width, 0.5 + y / height)
  }
  return geometry
}
