import { refuse } from '../errors.ts'

/** Profiles that are baked with the library; any other is the address of a map of kind 'profile'. */
export const PROFILES = ['sinusoidal', 'rectangular', 'blazed', 'triangular', 'sampled'] as const

/** The address of a profile's efficiency table: a baked one by name, any other by its own address. */
export function profileUrl(owner: string, profile: unknown, mapsPath: string): string {
  if (typeof profile !== 'string' || profile === '')
    refuse(
      owner,
      'profile',
      profile,
      `one of ${PROFILES.join(', ')}, or the address of a map without extension`,
    )
  return profile.includes('/') ? profile : `${mapsPath}profile-${profile}`
}
