import type { Method } from '../../web'

/** What methods are called. */
export const METHODS: Record<Method, string> = {
  'closed-form': 'Closed form',
  'wavelength-loop': 'Loop over wavelengths',
  'line-sum': 'Line sum',
  'jacobi-anger': 'Jacobi–Anger series',
  taylor: 'Taylor series',
  baked: 'Baked modes',
}
