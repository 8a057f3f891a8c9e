import type { DataTexture } from 'three'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { loadMap } from '../../web/maps/load'
import { DiffractionMaterial } from '../../web/materials/DiffractionMaterial'
import { DEFAULT_SETTINGS, type DiffractionMaterialOptions } from '../../web/materials/options'
import { coefficientsTexture, termsTexture } from '../../web/height-field/line-spectrum'
import { Grating } from '../../web/surfaces/grating'
import { HeightField } from '../../web/surfaces/height-field'
import { fakeBaked, fakeLobes, fakeMetals, fakeTerms, filesOf, serveFiles } from './fake-maps'
import { refuses } from './refuses'

let folder = 0
let mapsPath = ''

beforeEach(() => {
  mapsPath = `fields${++folder}/`
  serveFiles(
    filesOf({
      [`${mapsPath}height-field-x-jacobi-anger`]: fakeTerms(),
      [`${mapsPath}height-field-x-baked`]: fakeBaked(),
      [`${mapsPath}lobes-1931-2-D65`]: fakeLobes(),
      [`${mapsPath}metals`]: fakeMetals(),
    }),
  )
})

afterEach(() => {
  vi.unstubAllGlobals()
})

describe('a height field', () => {
  it('refuses values that mean nothing, and keeps the last good ones', () => {
    refuses(() => new HeightField({ field: '' }), 'HeightField', 'field')
    const field = new HeightField({ field: 'x', ior: 1.5 })
    refuses(() => (field.orientation = NaN), 'HeightField', 'orientation')
    refuses(() => (field.strength = 1.1), 'HeightField', 'strength')
    refuses(() => (field.ior = 0.9), 'HeightField', 'ior')
    expect(field).toMatchObject({ orientation: 0, strength: 1, ior: 1.5 })
  })

  it('reads the terms of its method, by name or by address', () => {
    const settings = { ...DEFAULT_SETTINGS, method: 'taylor' as const }
    const tables = (field: string, method: 'taylor' | 'jacobi-anger' | 'line-sum'): string =>
      new HeightField({ field }).tables({ ...settings, method }, 'm/').relief!
    expect(tables('x', 'taylor')).toBe('m/height-field-x-taylor')
    expect(tables('a/b', 'jacobi-anger')).toBe('a/b-jacobi-anger')
    expect(tables('x', 'line-sum')).toBe('m/height-field-x-jacobi-anger')
  })

  it('compiles interference in where nothing blurs the lines', async () => {
    const field = new HeightField({ field: 'x' })
    const settings = { ...DEFAULT_SETTINGS, method: 'jacobi-anger' as const }
    const load = async (): Promise<Record<string, Awaited<ReturnType<typeof loadMap>>>> =>
      Object.fromEntries(
        await Promise.all(
          Object.entries(field.tables(settings, mapsPath)).map(
            async ([name, url]) => [name, await loadMap(url)] as const,
          ),
        ),
      )
    const sharp = field.optics(await load(), settings)
    expect(sharp.underLights(0).defines).toEqual({ BLURRED: false })
    expect(sharp.underLights(0.001).defines).toEqual({ BLURRED: true })
    const rough = field.optics(await load(), { ...settings, roughness: 0.01 })
    expect(rough.underLights(0).defines).toEqual({ BLURRED: true })
  })
})

describe('a material', () => {
  it('takes a method that its surface has, first of all the surface’s default', async () => {
    const material = new DiffractionMaterial({ surface: new HeightField({ field: 'x' }), mapsPath })
    await material.ready
    expect(material.method).toBe('line-sum')
    expect(material.energy).toBe('kirchhoff')
    refuses(() => (material.method = 'closed-form'), 'DiffractionMaterial', 'method')
    refuses(() => (material.energy = 'conserving'), 'DiffractionMaterial', 'energy')
    material.method = 'jacobi-anger'
    expect(material.method).toBe('jacobi-anger')
    material.surface = new Grating({ period: 1, height: 0.1 })
    expect(material.method).toBe('closed-form')
    // Both surfaces have it.
    expect(material.energy).toBe('kirchhoff')
  })
})

describe('a baked pattern', () => {
  const baked = { method: 'baked', roughness: 0.02, metal: 'gold' } as const
  const made = async (
    options: Partial<DiffractionMaterialOptions>,
  ): Promise<DiffractionMaterial> => {
    const surface = new HeightField({ field: 'x' })
    const material = new DiffractionMaterial({
      surface,
      mapsPath,
      onError: () => undefined,
      ...baked,
      ...options,
    })
    await material.ready
    return material
  }

  it('is shown with the settings that were baked in', async () => {
    const material = await made({})
    expect(material.defines.BAKED).toBe('')
    expect(material.explain()).toContainEqual(
      expect.objectContaining({ feature: 'baked pattern of 1 modes', included: true }),
    )
  })

  it.each([
    ['roughness', { roughness: 0.01 }],
    ['metal', { metal: 'silver' }],
    ['coherence', { coherence: 8 }],
    ['energy', { energy: 'relative' }],
  ] as const)('refuses another %s by name', async (field, options) => {
    await expect(made(options)).rejects.toMatchObject({
      file: `${mapsPath}height-field-x-baked.json`,
      field,
    })
  })

  it('keeps what it shows when a setting does not fit', async () => {
    const material = await made({})
    refuses(() => (material.roughness = 0), `${mapsPath}height-field-x-baked.json`, 'roughness')
    expect(material.roughness).toBe(0.02)
  })
})

describe('the textures of terms', () => {
  it('hold each coefficient and its step to the next argument, two terms a texel', async () => {
    const relief = await loadMap(`${mapsPath}height-field-x-jacobi-anger`)
    expect(termsTexture(relief).image).toMatchObject({ width: 2, height: 3, depth: 3 })
    const { width, height, data } = coefficientsTexture(relief).image as DataTexture['image'] & {
      data: Float32Array
    }
    expect([width, height]).toEqual([4, 3])
    // Coefficient n at sample i is (4 n + i)/64.
    for (let n = 0; n < 6; n++)
      for (let i = 0; i < 4; i++) {
        const texel = 4 * (Math.floor(n / 2) * 4 + i) + 2 * (n % 2)
        const isThere = n < 5
        expect(data[texel]).toBe(isThere ? (4 * n + i) / 64 : 0)
        expect(data[texel + 1]).toBe(isThere && i < 3 ? 1 / 64 : 0)
      }
  })
})
