import { afterEach, describe, expect, it, vi } from 'vitest'
import { DiffractionError } from '../../web/errors'
import { arrayOf, expectKind, loadMap, valuesOf } from '../../web/maps/load'
import { MAX_SIDECAR_BYTES } from '../../web/maps/sidecar'
import { imageTexture } from '../../web/maps/image-texture'
import {
  fakeFoil,
  fakeProfile,
  filesOf,
  halves,
  png,
  pngOf,
  serveFiles,
  sha256,
  type FakeMap,
} from './fake-maps'

afterEach(() => {
  vi.unstubAllGlobals()
})

type Json = Record<string, unknown>

async function errorOf(map: FakeMap): Promise<DiffractionError> {
  serveFiles(filesOf({ 'maps/x': map }))
  const outcome: unknown = await loadMap('maps/x').catch((error: unknown) => error)
  expect(outcome).toBeInstanceOf(DiffractionError)
  return outcome as DiffractionError
}

/** The fake profile with one field of its sidecar replaced; an undefined value leaves the field out. */
function profileWith(path: string, value: unknown): FakeMap {
  const map = structuredClone(fakeProfile())
  const names = path.split('.')
  const last = names.pop()!
  let place = map.sidecar
  for (const name of names) place = place[name] as Record<string, unknown>
  place[last] = value
  return map
}

describe('a good map', () => {
  it('loads with its numbers', async () => {
    serveFiles(filesOf({ 'maps/x': fakeProfile() }))
    const map = await loadMap('maps/x')
    expect(map.verified).toBe(true)
    expect(map.sidecar.constants.max_phase).toEqual([20])
    expect(Array.from(valuesOf(arrayOf(map, 'efficiency')).slice(6, 10))).toEqual([
      0.25, 0.25, 0.5, 0.5,
    ])
  })

  it('loads unverified where the browser cannot digest', async () => {
    serveFiles(filesOf({ 'maps/x': fakeProfile() }))
    vi.stubGlobal('crypto', {})
    expect((await loadMap('maps/x')).verified).toBe(false)
  })

  it('keeps the colours of an image where its alpha is 0, and turns it upright', async () => {
    const pixels = Uint8Array.of(255, 0, 10, 0, 1, 2, 3, 4, 5, 6, 7, 0, 9, 10, 11, 12)
    serveFiles(filesOf({ 'maps/x': fakeFoil(pixels) }))
    const map = await loadMap('maps/x')
    expect(arrayOf(map, 'grating').data).toEqual(pixels)
    expect(valuesOf(arrayOf(map, 'grating'))[0]).toBe(1)
    const { data } = imageTexture(map, 'grating').image
    expect(data).toEqual(Uint8Array.of(...pixels.slice(8), ...pixels.slice(0, 8)))
  })

  it('is refused where another kind is needed', async () => {
    serveFiles(filesOf({ 'maps/x': fakeProfile() }))
    const map = await loadMap('maps/x')
    expect(() => expectKind(map, 'foil')).toThrow('maps/x.json: kind is "profile", expected foil')
  })
})

describe('a sidecar', () => {
  it.each([
    ['format', 'something else'],
    ['version', 2],
    ['version', undefined],
    ['kind', 'hologram'],
    ['quantity', 3],
    ['arrays', []],
    ['arrays.efficiency', undefined],
    ['arrays.efficiency.file', '../secret.bin'],
    ['arrays.efficiency.file', '/secret.bin'],
    ['arrays.efficiency.file', '..\\secret.bin'],
    ['arrays.efficiency.file', 'https://example.org/x.bin'],
    ['arrays.efficiency.file', 'C:x.bin'],
    ['arrays.efficiency.file', '..'],
    ['arrays.efficiency.file', 'x.json'],
    ['arrays.efficiency.file', 'a\0.bin'],
    ['arrays.efficiency.file', '\ud800.bin'],
    ['arrays.efficiency.dtype', 'uint8'],
    ['arrays.efficiency.dtype', 'float64'],
    ['arrays.efficiency.shape', [3]],
    ['arrays.efficiency.sha256', 'abc'],
    ['arrays.efficiency.channels', []],
    ['arrays.efficiency.axes', [{}, {}, {}]],
    ['arrays.efficiency.decode', [[0, 1]]],
    ['constants.max_phase', undefined],
    ['constants.max_phase', 'twenty'],
    ['constants.max_phase', [1, 2]],
  ])('with %s = %j is refused by that name', async (field, value) => {
    const error = await errorOf(profileWith(field, value))
    expect(error).toMatchObject({ file: 'maps/x.json' })
    // Within an axis it is the first of its fields that is named.
    expect(error.field.replace(/\[\d+\]\..*$/, '')).toBe(field)
  })

  it.each([
    ['arrays.efficiency.shape', [3, 0, 1], 'arrays.efficiency.shape[1]'],
    ['arrays.efficiency.shape', [3, 8, 2], 'arrays.efficiency.channels'],
    ['arrays.efficiency.shape', [2 ** 32, 2 ** 32, 1], 'arrays.efficiency.shape'],
    ['arrays.efficiency.shape', [3, 1e308, 1], 'arrays.efficiency.shape'],
    ['arrays.efficiency.shape', [3, 9, 1], 'arrays.efficiency.axes[1].size'],
  ])('with %s = %j is refused at %s', async (path, value, field) => {
    expect((await errorOf(profileWith(path, value))).field).toBe(field)
  })

  it.each([
    ['size', 9],
    ['mapping', 'cubic'],
    ['first', 'zero'],
    ['last', 0],
  ])('with %s = %j of an axis is refused by that name', async (field, value) => {
    const map = structuredClone(fakeProfile())
    const { efficiency } = map.sidecar.arrays as Record<string, { axes: Record<string, unknown>[] }>
    efficiency!.axes[1]![field] = value
    expect((await errorOf(map)).field).toBe(`arrays.efficiency.axes[1].${field}`)
  })

  it.each([
    ['dtype', { dtype: 'float16', file: 'foil.normal.bin', decode: undefined }],
    [
      'shape',
      {
        shape: [1, 1, 3],
        channels: ['a', 'b', 'c'],
        decode: [
          [0, 1],
          [0, 1],
          [0, 1],
        ],
      },
    ],
    ['decode', { decode: undefined }],
  ])('of a foil whose bumps have another %s is refused', async (field, change) => {
    const normal = { pixels: new Uint8Array(4), size: [1, 1] as [number, number] }
    const map = structuredClone(fakeFoil(undefined, undefined, normal))
    Object.assign((map.sidecar.arrays as Record<string, object>).normal!, change)
    expect((await errorOf(map)).field).toBe(`arrays.normal.${field}`)
  })

  it.each([
    ['not JSON', '{'],
    ['behind a byte-order mark', '\ufeff{}'],
    ['not UTF-8', Uint8Array.of(0x7b, 0x22, 0xff, 0x22, 0x3a, 0x31, 0x7d)],
  ])('that is %s is refused', async (_case, contents) => {
    serveFiles({ 'maps/x.json': contents })
    await expect(loadMap('maps/x')).rejects.toMatchObject({ file: 'maps/x.json', expected: 'JSON' })
  })

  it('nested too deep to be written into a message is refused all the same', async () => {
    const deep = `{"format": ${'['.repeat(100_000)}${']'.repeat(100_000)}}`
    serveFiles({ 'maps/x.json': deep })
    await expect(loadMap('maps/x')).rejects.toThrow('maps/x.json: format is object')
  })

  it('that is too large is refused', async () => {
    serveFiles({ 'maps/x.json': ' '.repeat(MAX_SIDECAR_BYTES + 1) })
    await expect(loadMap('maps/x')).rejects.toMatchObject({ file: 'maps/x.json', field: 'bytes' })
  })

  it.each(['arrays', 'constants'])('with __proto__ among its %s is refused', async (field) => {
    const map = structuredClone(fakeProfile())
    const value = field === 'arrays' ? (map.sidecar.arrays as Json).efficiency : 1
    const descriptor = { value, enumerable: true }
    Object.defineProperty(map.sidecar[field], '__proto__', descriptor)
    expect((await errorOf(map)).field).toBe(`${field}.__proto__`)
  })

  it('with a file name that an address would read otherwise asks for that name', async () => {
    const map = structuredClone(fakeProfile())
    const { efficiency } = map.sidecar.arrays as Record<string, Json>
    efficiency!.file = '%2e%2e?#.bin'
    expect((await errorOf(map)).file).toBe('maps/%252e%252e%3F%23.bin')
  })

  it('whose decoded values single precision cannot hold is refused', async () => {
    const map = structuredClone(fakeFoil())
    const { grating } = map.sidecar.arrays as Record<string, { decode: number[][] }>
    grating!.decode[2] = [1, 1e39]
    expect((await errorOf(map)).field).toBe('arrays.grating.decode[2]')
  })

  it('that is missing is named', async () => {
    serveFiles({})
    await expect(loadMap('maps/x')).rejects.toThrow('maps/x.json: file is "HTTP 404"')
  })
})

describe('a binary', () => {
  const spoil = (bytes: Uint8Array, isHashed = true): FakeMap => {
    const map = structuredClone(fakeProfile())
    map.files = { 'profile.efficiency.bin': bytes }
    const { efficiency } = map.sidecar.arrays as Record<string, Record<string, unknown>>
    if (isHashed) efficiency!.sha256 = sha256(bytes)
    return map
  }

  it('that is missing is named', async () => {
    const map = structuredClone(fakeProfile())
    map.files = {}
    expect(await errorOf(map)).toMatchObject({ file: 'maps/profile.efficiency.bin', field: 'file' })
  })

  it('that is truncated is refused by its length', async () => {
    const error = await errorOf(spoil(new Uint8Array(47)))
    expect(error).toMatchObject({ field: 'bytes', value: 47 })
    expect(error.message).toContain('48')
    expect(error.message).toContain('truncated')
  })

  it('that goes on for ever is refused as soon as it is too long', async () => {
    const endless = new ReadableStream({
      pull: (controller) => {
        controller.enqueue(new Uint8Array(1000))
      },
    })
    const sidecar = JSON.stringify(fakeProfile().sidecar)
    vi.stubGlobal('fetch', (url: string) =>
      Promise.resolve(new Response(url.endsWith('.json') ? sidecar : endless)),
    )
    await expect(loadMap('maps/x')).rejects.toMatchObject({
      file: 'maps/profile.efficiency.bin',
      value: 'more than 48',
    })
  })

  it('whose transfer breaks off is named', async () => {
    const broken = new ReadableStream({
      start: (controller) => {
        controller.error(new TypeError('network error'))
      },
    })
    vi.stubGlobal('fetch', () => Promise.resolve(new Response(broken)))
    const error: unknown = await loadMap('maps/x').catch((cause: unknown) => cause)
    expect(error).toBeInstanceOf(DiffractionError)
    expect(error).toMatchObject({ file: 'maps/x.json', field: 'file' })
  })

  it('of another bake is refused by its checksum', async () => {
    const error = await errorOf(spoil(halves(Array.from({ length: 24 }, () => 0.75)), false))
    expect(error.field).toBe('SHA-256')
  })

  it('with NaN or infinite values is refused with their number', async () => {
    const values = Array.from({ length: 24 }, (_, i) => (i < 3 ? 1 : 0))
    const bytes = halves(values)
    new Uint16Array(bytes.buffer).set([0x7c00, 0xfc00, 0x7e01])
    expect(await errorOf(spoil(bytes))).toMatchObject({ value: 3, expected: '0' })
  })
})

describe('an image', () => {
  const spoil = (bytes: Uint8Array): FakeMap => {
    const map = structuredClone(fakeFoil())
    map.files = { 'foil.grating.png': bytes }
    const { grating } = map.sidecar.arrays as Record<string, Record<string, unknown>>
    grating!.sha256 = sha256(bytes)
    return map
  }
  const pixels = new Uint8Array(16)
  const HEADER = Uint8Array.of(0, 0, 0, 2, 0, 0, 0, 2, 8, 6, 0, 0, 0)

  it.each([
    ['three channels', png(2, 2, pixels, { 9: 2 }), 'IHDR colour type'],
    ['16 bits', png(2, 2, pixels, { 8: 16 }), 'IHDR bit depth'],
    ['another size', png(1, 2, pixels), 'size (rows, columns)'],
    ['a size far above its rows', png(2, 2, pixels, { 0: 255, 4: 255 }), 'size (rows, columns)'],
    ['more rows than its size', pngOf(HEADER, new Uint8Array(2 ** 24)), 'IDAT bytes'],
    ['fewer rows than its size', pngOf(HEADER, new Uint8Array(9)), 'IDAT bytes'],
    ['no PNG inside', new Uint8Array(64), 'signature'],
    ['its end missing', png(2, 2, pixels).subarray(0, 50), 'bytes'],
  ])('with %s is refused', async (_case, bytes, field) => {
    expect(await errorOf(spoil(bytes))).toMatchObject({ file: 'maps/foil.grating.png', field })
  })
})
