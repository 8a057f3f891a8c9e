import { PlaneGeometry } from 'three'

/** Bends a plane about its vertical middle line: `angle` (rad) is what the normal turns from edge to edge. */
export function bendPlane(geometry: PlaneGeometry, angle: number): void {
  const { width } = geometry.parameters
  const position = geometry.getAttribute('position')
  const normal = geometry.getAttribute('normal')
  const uv = geometry.getAttribute('uv')
  for (let i = 0; i < position.count; i++) {
    const turn = (uv.getX(i) - 0.5) * angle
    // Arc length is kept, as paper keeps it; sin(x)/x and (1 − cos x)/x tend to 1 and 0.
    const isFlat = Math.abs(angle) < 1e-6
    const radius = isFlat ? 0 : width / angle
    const x = isFlat ? (uv.getX(i) - 0.5) * width : radius * Math.sin(turn)
    const z = isFlat ? 0 : radius * (Math.cos(turn) - Math.cos(angle / 4))
    position.setXYZ(i, x, position.getY(i), z)
    normal.setXYZ(i, Math.sin(turn), 0, Math.cos(turn))
  }
  position.needsUpdate = normal.needsUpdate = true
  geometry.computeBoundingSphere()
}
