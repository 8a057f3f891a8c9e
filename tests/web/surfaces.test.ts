import {
  LinearFilter,
  LinearMipmapLinearFilter,
  RepeatWrapping,
  Vector2,
  type DataTexture,
} from 'three'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { loadMap } from '../../web/maps/load'
import { DEFAULT_SETTINGS } from '../../web/materials/options'
import { Foil, type FoilOptions } from '../../web/surfaces/foil'
import { Grating } from '../../web/surfaces/grating'
import { serveBakedMaps } from './baked-maps'
import {
  fakeFoil,
  fakeLobes,
  fakeMetals,
  fakeProfile,
  filesOf,
  serveFiles,
  STEEPEST,
} from './fake-maps'
import { refuses } from './refuses'

const options = { period: 1.6, height: 0.12 }
const notNumbers = [0, -1, NaN, Infinity, '1', undefined]

afterEach(() => {
  vi.unstubAllGlobals()
})

describe('a grating', () => {
  it.each(notNumbers)('refuses a period or a height of %s', (value) => {
    const grating = new Grating(options)
    refuses(() => (grating.period = value as number), 'Grating', 'period')
    refuses(() => (grating.height = value as number), 'Grating', 'height')
    refuses(() => new Grating({ ...options, period: value as number }), 'Grating', 'period')
    expect(grating.period).toBe(1.6)
    expect(grating.height).toBe(0.12)
  })

  it('refuses other values that mean nothing', () => {
    const grating = new Grating(options)
    refuses(() => (grating.orientation = NaN), 'Grating', 'orientation')
    refuses(() => (grating.strength = 1.1), 'Grating', 'strength')
    refuses(() => (grating.tracks = 'spiral' as 'circular'), 'Grating', 'tracks')
    refuses(() => (grating.profile = ''), 'Grating', 'profile')
  })

  it.each([
    // 1/a against (2.63/0.08 + √28) √(1/(8π²σ²) + 2.63² ((2 · roughness)² + radius²))
    { period: 3.6, radius: 0, settings: {}, wide: false },
    { period: 3.9, radius: 0, settings: {}, wide: true },
    { period: 1.8, radius: 4.65e-3, settings: {}, wide: false },
    { period: 1.9, radius: 4.65e-3, settings: {}, wide: true },
    { period: 0.6, radius: 0, settings: { roughness: 0.0175 }, wide: true },
    { period: 1, radius: 0, settings: { coherence: 4 }, wide: true },
    { period: 3.9, radius: 0, settings: { method: 'wavelength-loop' as const }, wide: false },
  ])('knows whether other orders than 0 have wide lobes: %j', async (example) => {
    serveBakedMaps()
    const grating = new Grating({ period: example.period, height: 0.1 })
    const optics = grating.optics(
      {
        profile: await loadMap('maps/baked/profile-sinusoidal'),
        lobes: await loadMap('maps/baked/lobes-1931-2-D65'),
        metals: await loadMap('maps/baked/metals'),
      },
      { ...DEFAULT_SETTINGS, ...example.settings },
    )
    expect(optics.underLights(example.radius).defines).toEqual({ WIDE_LOBES: example.wide })
  })

  it('refuses a height beyond its table, once that is known', async () => {
    serveFiles(filesOf({ 'p/x': fakeProfile(10), 'l/x': fakeLobes(), 'm/x': fakeMetals() }))
    const tables = {
      profile: await loadMap('p/x'),
      lobes: await loadMap('l/x'),
      metals: await loadMap('m/x'),
    }
    const grating = new Grating(options)
    grating.optics(tables, DEFAULT_SETTINGS)
    // 2π · 2 h0 / 0.38 = 10 at h0 = 0.3024 µm.
    grating.height = 0.302
    refuses(() => (grating.height = 0.303), 'Grating', 'height')
    expect(grating.height).toBe(0.302)
    const tooHigh = new Grating({ ...options, height: 0.31 })
    refuses(() => tooHigh.optics(tables, DEFAULT_SETTINGS), 'Grating', 'height')
  })

  it('turns its grating vector without anything but a uniform', () => {
    const grating = new Grating(options)
    const { version } = grating
    grating.orientation = Math.PI / 2
    expect(grating.uniforms.uGratingDirection.value.x).toBeCloseTo(0, 15)
    expect(grating.uniforms.uGratingDirection.value.y).toBe(1)
    expect(grating.version).toBe(version)
  })

  it('asks for tables by the names of profile, observer and illuminant', () => {
    const settings = { ...DEFAULT_SETTINGS, illuminant: 'A' }
    expect(new Grating({ ...options, profile: 'blazed' }).tables(settings, 'm/')).toEqual({
      profile: 'm/profile-blazed',
      lobes: 'm/lobes-1931-2-A',
      metals: 'm/metals',
    })
    expect(new Grating({ ...options, profile: 'my/profile' }).tables(settings, 'm/').profile).toBe(
      'my/profile',
    )
  })
})

describe('a foil', () => {
  beforeEach(() => {
    serveFiles(filesOf({ 'maps/foil': fakeFoil(), 'maps/profile': fakeProfile() }))
  })

  it('takes height, periods, profile and decoding from its sidecar', async () => {
    const foil = new Foil(await loadMap('maps/foil'), { repeat: new Vector2(2, 3) })
    expect(foil.height).toBe(0.1)
    expect(foil.period).toEqual([1.25, 2.5])
    expect(foil.profile).toBe('sinusoidal')
    expect(foil.uniforms.uFoilOffset.value.toArray()).toEqual([-1, -1, 0, 0])
    expect(foil.uniforms.uFoilScale.value.toArray()).toEqual([2, 2, 0.8, 1])
    expect(foil.repeat.toArray()).toEqual([2, 3])
  })

  it('can be given another height', async () => {
    const map = await loadMap('maps/foil')
    expect(new Foil(map, { height: 0.2 }).height).toBe(0.2)
    refuses(() => new Foil(map, { height: NaN }), 'Foil', 'height')
  })

  it('shows the mean of its texels unless told not to, and says so', async () => {
    serveBakedMaps()
    const tables = {
      profile: await loadMap('maps/baked/profile-sinusoidal'),
      lobes: await loadMap('maps/baked/lobes-1931-2-D65'),
      metals: await loadMap('maps/baked/metals'),
    }
    const map = await loadMap('maps/baked/foil-polygons')
    const filtered = (options: FoilOptions) => {
      const { defines, uniforms, features } = new Foil(map, options).optics(
        tables,
        DEFAULT_SETTINGS,
      )
      const said = features.find(({ feature }) => feature === 'mean over the texels of a pixel')!
      const fetched = features.find(({ feature }) => feature.endsWith('from a map'))!
      expect(fetched.included).toBe(!said.included)
      expect('uFoilShares' in uniforms).toBe(said.included)
      expect(defines['FOIL_GRATINGS']).toBe(said.included ? 12 : undefined)
      return said.included
    }
    expect(filtered({})).toBe(true)
    expect(filtered({ filtered: false })).toBe(false)
  })

  it('reads bumps between texels where its map has them, and knows nothing of them where not', async () => {
    const flat = new Foil(await loadMap('maps/foil'))
    expect(flat.hasBumps).toBe(false)
    expect(flat.defines).toEqual({})
    expect(Object.keys(flat.uniforms).join()).not.toContain('Normal')

    const pixels = Uint8Array.of(1, 2, 255, 255, 3, 4, 255, 255)
    serveFiles(filesOf({ 'maps/bumpy': fakeFoil(undefined, undefined, { pixels, size: [1, 2] }) }))
    const { hasBumps, defines, uniforms } = new Foil(await loadMap('maps/bumpy'))
    expect(hasBumps).toBe(true)
    expect(defines).toEqual({ FOIL_BUMPS: '' })
    const named = uniforms as unknown as Record<string, { value: unknown }>
    const texture = named.uFoilNormal!.value as DataTexture
    // v grows upwards.
    expect(Array.from(texture.image.data!)).toEqual([3, 4, 255, 255, 1, 2, 255, 255])
    expect([texture.wrapS, texture.wrapT]).toEqual([RepeatWrapping, RepeatWrapping])
    expect(texture.magFilter).toBe(LinearFilter)
    expect([texture.minFilter, texture.generateMipmaps]).toEqual([LinearMipmapLinearFilter, true])
    // Texel 128 is none, 127 more the steepest.
    const offset = (named.uFoilNormalOffset!.value as Vector2).x
    const scale = (named.uFoilNormalScale!.value as Vector2).y
    expect(offset + (scale * 128) / 255).toBeCloseTo(0, 12)
    expect(offset + scale).toBeCloseTo(STEEPEST, 12)
  })

  it('refuses a map of another kind, and a repeat that is none', async () => {
    const profile = await loadMap('maps/profile')
    refuses(() => new Foil(profile), 'maps/profile.json', 'kind')
    const foil = new Foil(await loadMap('maps/foil'))
    refuses(() => (foil.repeat = new Vector2(0, 1)), 'Foil', 'repeat')
  })
})
