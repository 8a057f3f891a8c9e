import { DataUtils, type DataTexture, type Vector2 } from 'three'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { loadMap } from '../../web/maps/load'
import { DiffractionMaterial } from '../../web/materials/DiffractionMaterial'
import { DEFAULT_SETTINGS, type DiffractionMaterialOptions } from '../../web/materials/options'
import { cutWindow } from '../../web/height-field/cut-window'
import { coefficientsTexture, termsTexture } from '../../web/height-field/line-spectrum'
import { Grating } from '../../web/surfaces/grating'
import { HeightField } from '../../web/surfaces/height-field'
import {
  BAKED_RECIPE,
  fakeBaked,
  fakeLobes,
  fakeMetals,
  fakeTerms,
  filesOf,
  serveFiles,
} from './fake-maps'
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

  it('takes counts of patches only', () => {
    for (const tiles of [0, -2, 2.5, NaN, '4', [3], [3, 0], [1, 2, 3]] as unknown as number[])
      refuses(() => new HeightField({ field: 'x', tiles }), 'HeightField', 'tiles')
    expect(new HeightField({ field: 'x' }).tiles).toBeNull()
    expect(new HeightField({ field: 'x', tiles: 4 }).tiles).toEqual([4, 4])
    expect(new HeightField({ field: 'x', tiles: [3, 8] }).tiles).toEqual([3, 8])
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
    // Nobody gave the field's.
    expect(material.energy).toBe('conserving')
  })

  it('shows finite repeats but line by line', async () => {
    const surface = new HeightField({ field: 'x', tiles: [3, 8] })
    const material = new DiffractionMaterial({ surface, mapsPath })
    await material.ready
    expect(material.method).toBe('jacobi-anger')
    expect(material.defines.TILES).toBe('')
    expect(material.explain()).toContainEqual(
      expect.objectContaining({ feature: 'finite repeats', included: true }),
    )
    refuses(() => (material.method = 'line-sum'), 'DiffractionMaterial', 'method')
    material.surface = new HeightField({ field: 'x' })
    await material.ready
    expect(material.defines).not.toHaveProperty('TILES')
  })
})

describe('a material with a largest error', () => {
  // The report's figures for rough height fields: the baked pattern is the faster one, and errs by 0.0013.
  const options = { maxError: 0.01, roughness: 0.02, metal: 'gold' } as const
  const made = async (recipe?: object): Promise<DiffractionMaterial> => {
    const at = `${mapsPath}other/`
    serveFiles(
      filesOf({
        [`${at}height-field-x-jacobi-anger`]: fakeTerms(recipe),
        [`${at}height-field-x-baked`]: fakeBaked(),
        [`${at}lobes-1931-2-D65`]: fakeLobes(),
        [`${at}metals`]: fakeMetals(),
      }),
    )
    const surface = new HeightField({ field: 'x' })
    const material = new DiffractionMaterial({ surface, mapsPath: at, ...options })
    await material.ready
    expect(material.method).toBe('line-sum')
    // What the map says is heard with the next look.
    await material.ready
    return material
  }

  it('takes the baked pattern, once a map says that there is one', async () => {
    const material = await made(BAKED_RECIPE)
    expect(material.method).toBe('baked')
    expect(material.defines.BAKED).toBe('')
    const chosen = material
      .explain()
      .find(({ feature }) => feature.startsWith('error under lights'))
    expect(chosen!.why).toContain("method 'baked'")
  })

  it('leaves it where a setting is another than was baked in, and comes back', async () => {
    const material = await made(BAKED_RECIPE)
    material.roughness = 0.01
    await material.ready
    expect(material.method).toBe('line-sum')
    expect(material.defines).not.toHaveProperty('BAKED')
    material.roughness = 0.02
    await material.ready
    expect(material.method).toBe('baked')
  })

  it('keeps to the terms where no map speaks of a baked one, or where the method was given', async () => {
    expect((await made()).method).toBe('line-sum')
    const { ready, method } = Object.assign(await made(BAKED_RECIPE), { method: 'jacobi-anger' })
    await ready
    expect(method).toBe('jacobi-anger')
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
    ['tiles', { surface: new HeightField({ field: 'x', tiles: 4 }) }],
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

describe('a window cut to some patches', () => {
  /** Step, in deviations, and the lobes along x and y of a row. */
  const lobes = (window: ReturnType<typeof cutWindow>, row: number): [number, number[][]] => {
    const { defines, uniforms } = window
    const { data, width } = (uniforms.uCutLobes!.value as DataTexture).image
    const axes = [0, 2].map((c) =>
      Array.from({ length: width }, (_, k) =>
        DataUtils.fromHalfFloat((data as Uint16Array)[4 * (row * width + k) + c]!),
      ),
    )
    return [Number(defines.CUT_REACH) / (width - 1), axes]
  }
  const SHARES = 32

  it('has the lobes of a slit where light is coherent over all of it', () => {
    const window = cutWindow([2, 3], [2.5, 4], 1e5)
    const lengths = [5, 12]
    const deviations = (window.uniforms.uCutVariance!.value as Vector2).toArray().map(Math.sqrt)
    // The density (sin πNTf/πf)²/NT has the peak NT.
    lengths.forEach((length, axis) => {
      expect(deviations[axis]).toBeCloseTo(1 / (Math.sqrt(2 * Math.PI) * length), 8)
    })
    const [step, sharp] = lobes(window, SHARES)
    const [, unblurred] = lobes(window, SHARES - 1)
    for (const k of [0, 1, 40, 333, 2000])
      for (const axis of [0, 1]) {
        const x = Math.PI * lengths[axis]! * deviations[axis]! * k * step
        const slit = k === 0 ? 1 : Math.sin(x) / x
        expect(sharp[axis]![k]).toBeCloseTo(slit, 3)
        expect(unblurred[axis]![k]).toBeCloseTo(Math.abs(slit), 3)
      }
  })

  it('has those of the Gaussian where it ends before the patches do', () => {
    const window = cutWindow([40, 5000], [4, 4], 8)
    const variance = (window.uniforms.uCutVariance!.value as Vector2).x
    expect(variance * 8 * Math.PI ** 2 * 8 ** 2).toBeCloseTo(1, 6)
    for (const row of [0, 15, SHARES - 1, SHARES]) {
      const [step, axes] = lobes(window, row)
      for (const k of [0, 300, 900])
        for (const axis of [0, 1])
          expect(axes[axis]![k]).toBeCloseTo(Math.exp(-0.25 * (k * step) ** 2), 3)
    }
  })

  it('is made again for another coherence or patch alone', () => {
    const tiles = [2, 9] as const
    const made = cutWindow(tiles, [2.5, 4], 16)
    const isKept = (period: [number, number], coherence: number): boolean =>
      cutWindow(tiles, period, coherence) === made
    expect(isKept([2.5, 4], 16)).toBe(true)
    expect(isKept([2.5, 4], 8)).toBe(false)
    expect(isKept([2.5, 5], 16)).toBe(false)
  })

  it('keeps its energy when it is blurred', () => {
    for (const row of [2, 8, 20, 30]) {
      const [step, axes] = lobes(cutWindow([2, 9], [2.5, 2.5], 16.25), row)
      for (const roots of axes) {
        const powers = roots.map((root) => root * root)
        const energy = step * (2 * powers.reduce((a, b) => a + b) - powers[0]!)
        expect(energy / Math.sqrt(2 * Math.PI)).toBeCloseTo(1, 2)
      }
    }
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
