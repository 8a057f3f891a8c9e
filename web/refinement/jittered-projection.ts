import type { Camera } from 'three'

/**
 * Runs `draw` with the camera's picture moved by (x, y) in normalised device coordinates, where the picture is 2 wide and 2
 * high; of any projection, a view offset included.
 */
export function jitteredProjection(camera: Camera, x: number, y: number, draw: () => void): void {
  const projection = camera.projectionMatrix.clone()
  const inverse = camera.projectionMatrixInverse.clone()
  // What is added to the first and second coordinate is divided by the fourth afterwards.
  const { elements } = camera.projectionMatrix
  for (let column = 0; column < 16; column += 4) {
    elements[column]! += x * elements[column + 3]!
    elements[column + 1]! += y * elements[column + 3]!
  }
  camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert()
  try {
    draw()
  } finally {
    camera.projectionMatrix.copy(projection)
    camera.projectionMatrixInverse.copy(inverse)
  }
}
