import { HeightField, type Method, type Surface } from '../../web'

/** The height fields that are baked, and what they show. */
export const FIELDS = {
  bumps: 'Bumps, 0.15 µm',
  fingers: 'Fingers (snake)',
  cosine: 'Cosine',
  blazed: 'Blazed, 2.5 µm',
  'pits-cd': 'Pits of a CD',
  'pits-dvd': 'Pits of a DVD',
  roughness: 'Random roughness',
} as const
export type FieldName = keyof typeof FIELDS

/** Methods that need a map of their own, and the fields for which it is baked. */
const BAKED_FOR: Partial<Record<Method, readonly string[]>> = {
  taylor: ['bumps', 'fingers', 'cosine', 'blazed'],
  baked: ['bumps', 'fingers'],
}

/** The surface's methods, less those whose maps are not baked; its default first. */
export function bakedMethods(surface: Surface): readonly Method[] {
  if (!(surface instanceof HeightField)) return surface.methods
  return surface.methods.filter((method) => BAKED_FOR[method]?.includes(surface.field) ?? true)
}
