import { Color, MeshPhysicalMaterial, MeshStandardMaterial, Vector3 } from 'three'
import type { DiffractionMaterial } from '../materials/DiffractionMaterial.ts'
import { metalReflectance } from '../spectrum/metal-reflectance.ts'
import { seenIn, spectralNodes } from '../spectrum/spectral-nodes.ts'
import { spectrumUrls, xyzToRgb } from '../spectrum/spectrum-maps.ts'
import { HeightField } from '../surfaces/height-field.ts'
import { tableOf } from './tables.ts'

/** One a nanometre. */
const WAVELENGTHS = 401

/**
 * What a viewer shows that does not know of diffraction: the metal as if it were polished, or the dielectric in the colours of
 * the matt base. Name, sides, opacity, normals and bumps are the material's.
 */
export async function plainMaterial(material: DiffractionMaterial): Promise<MeshStandardMaterial> {
  const { name, side, transparent, depthWrite, opacity, userData } = material
  const { normalMap, normalScale, bumpMap, bumpScale, surface } = material
  const common = {
    ...{ name, side, transparent, depthWrite, opacity, userData },
    ...{ normalMap, normalScale, bumpMap, bumpScale },
    // A Gaussian of tilts of deviation σ has Beckmann's α = √2 σ, and glTF's α is the roughness squared.
    roughness: Math.min(Math.sqrt(Math.SQRT2 * material.roughness), 1),
  }
  if (surface instanceof HeightField && surface.ior !== null) {
    const { color, map } = material
    return new MeshPhysicalMaterial({ ...common, color, map, ior: surface.ior, metalness: 0 })
  }
  return new MeshStandardMaterial({
    ...common,
    color: await metalColor(material),
    metalness: 1,
  })
}

/** Linear sRGB that light along the normal takes on in the metal; white for a perfect mirror. */
async function metalColor(material: DiffractionMaterial): Promise<Color> {
  const urls = spectrumUrls(material, material.mapsPath)
  const lobes = await tableOf(material, urls.lobes)
  const metals = await tableOf(material, urls.metals)
  const bands = spectralNodes(lobes, WAVELENGTHS, 'uniform')
  const xyz = new Vector3()
  for (const { tints } of seenIn(bands, metalReflectance(metals, material.metal)))
    tints.forEach((value, i) => xyz.setComponent(i % 3, xyz.getComponent(i % 3) + value))
  // Gold is redder than the display's gamut.
  const [r, g, b] = xyz.applyMatrix3(xyzToRgb(lobes)).toArray()
  return new Color().setRGB(...([r, g, b].map(share) as [number, number, number]))
}

function share(value: number): number {
  return Math.min(Math.max(value, 0), 1)
}
