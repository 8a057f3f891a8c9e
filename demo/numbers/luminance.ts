import { ColorManagement, Vector3 } from 'three'

const [red, green, blue] = ColorManagement.getLuminanceCoefficients(new Vector3()).toArray()

/** Relative luminance of linear sRGB, as three's shaders weigh it. */
export function luminance(r: number, g: number, b: number): number {
  return red * r + green * g + blue * b
}
