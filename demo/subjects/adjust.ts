import type { DiffractionMaterial } from '../../web'

type Settings = Partial<
  Pick<DiffractionMaterial, 'metal' | 'illuminant' | 'coherence' | 'roughness'>
>

/** Changes settings. They are part of a baked pattern, so that a change needs the surface's default method instead. */
export function adjust(material: DiffractionMaterial, settings: Settings): void {
  const changes = Object.entries(settings).some(
    ([name, value]) => material[name as keyof Settings] !== value,
  )
  if (changes && material.method === 'baked') material.method = material.surface.methods[0]!
  Object.assign(material, settings)
}
