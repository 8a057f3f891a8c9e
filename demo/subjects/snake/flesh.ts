import { Mesh, MeshStandardMaterial, PlaneGeometry } from 'three'
import { LENGTH, pointAt } from './body'

/** Share of the body's radius: deeper than any scale's edge. */
const DEPTH = 0.94

/** What shows between the scales: matt and dark. */
export function flesh(): Mesh {
  const geometry = new PlaneGeometry(1, 1, 160, 18)
  const position = geometry.getAttribute('position')
  const uv = geometry.getAttribute('uv')
  for (let i = 0; i < position.count; i++) {
    const { x, y, z } = pointAt(uv.getX(i) * LENGTH, 2 * Math.PI * uv.getY(i), DEPTH)
    position.setXYZ(i, x, y, z)
  }
  geometry.computeVertexNormals()
  return new Mesh(geometry, new MeshStandardMaterial({ color: 0x0c0908, roughness: 0.9 }))
}
