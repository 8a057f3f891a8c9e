/** Reflectance of a smooth dielectric for unpolarised light: Fresnel's equations. cosine: to the normal outside; ior: above 1. */
export function fresnel(cosine: number, ior: number): number {
  const inside = Math.sqrt(ior ** 2 - 1 + cosine ** 2)
  const s = (cosine - inside) / (cosine + inside)
  const p = (ior ** 2 * cosine - inside) / (ior ** 2 * cosine + inside)
  return (s * s + p * p) / 2
}
