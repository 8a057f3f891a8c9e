import type { DiffractionMaterial, Method } from '../../web'
import { bakedMethods } from '../subjects/fields'

/** Samples of the spectrum along each arc of the environment, as the papers take them. */
const SEED_NODES = 21

/**
 * The method to set beside a material's: the papers', which is the sum over wavelengths, each 5 nm, of gratings and the
 * Taylor series of a height field; where the material draws by that, or it was not baked, another one of the surface.
 */
export function otherMethod({ surface, method }: DiffractionMaterial): Method {
  const methods = bakedMethods(surface)
  const seeds: Method[] = ['wavelength-loop', 'taylor', 'jacobi-anger']
  const other = [...seeds.filter((seed) => methods.includes(seed)), ...methods].find(
    (candidate) => candidate !== method,
  )
  return other ?? method
}

/** A material that draws the same surface by another method. */
export function otherMaterial(material: DiffractionMaterial, method: Method): DiffractionMaterial {
  const other = material.clone()
  other.method = method
  if (method === 'wavelength-loop') other.environmentNodes = SEED_NODES
  return other
}

/** Brings the other material to what the first one shows; a setting that is the same already costs nothing. */
export function follow(other: DiffractionMaterial, material: DiffractionMaterial): void {
  const { surface, metal, illuminant, observer, coherence, roughness } = material
  const { coat, coatIor, coatRoughness } = material
  // How it is drawn stays its own: method, nodes, steps.
  Object.assign(other, { surface, metal, illuminant, observer, coherence, roughness })
  Object.assign(other, { coat, coatIor, coatRoughness })
}
