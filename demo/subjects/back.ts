import { BackSide, Mesh, MeshStandardMaterial, type BufferGeometry } from 'three'

/** The back of something thin: matt and dark. */
export function backOf(geometry: BufferGeometry): Mesh {
  return new Mesh(
    geometry,
    new MeshStandardMaterial({ color: 0x202226, roughness: 0.8, side: BackSide }),
  )
}
