import { createHash } from 'node:crypto'
import { deflateSync } from 'node:zlib'
import { DataUtils } from 'three'
import { vi } from 'vitest'

/** A map as files, each to be spoilt before it is served. */
export interface FakeMap {
  sidecar: Record<string, unknown>
  files: Record<string, Uint8Array>
}

/** Serves these files to `fetch`, and 404 for all others. */
export function serveFiles(files: Record<string, Uint8Array | string>): void {
  vi.stubGlobal('fetch', (url: string) => {
    const body = files[url]
    return Promise.resolve(
      body === undefined
        ? new Response(null, { status: 404 })
        : new Response(body as BodyInit, { status: 200 }),
    )
  })
}

/** The files of maps by address, to be given to {@link serveFiles}. */
export function filesOf(maps: Record<string, FakeMap>): Record<string, Uint8Array | string> {
  const files: Record<string, Uint8Array | string> = {}
  for (const [url, { sidecar, files: binaries }] of Object.entries(maps)) {
    files[`${url}.json`] = JSON.stringify(sidecar)
    const folder = url.slice(0, url.lastIndexOf('/') + 1)
    for (const [name, bytes] of Object.entries(binaries)) files[folder + name] = bytes
  }
  return files
}

/** A profile whose light all goes into orders −1 to 1, with a phase of up to 20 rad. */
export function fakeProfile(maxPhase = 20): FakeMap {
  const values = [0.25, 0.5, 0.25].flatMap((share) => Array.from({ length: 8 }, () => share))
  return makeMap('profile', { max_order: 1, max_phase: maxPhase, symmetric: 1 }, [
    {
      name: 'efficiency',
      bytes: halves(values),
      dtype: 'float16',
      shape: [3, 8, 1],
      axes: [axis('order', 3, 'linear', -1, 1), axis('phase', 8, 'square', 0, maxPhase)],
    },
  ])
}

export function fakeLobes(): FakeMap {
  const constants = {
    white_xyz: [0.95, 1, 1.09],
    xyz_to_rgb: [1, 2, 3, 4, 5, 6, 7, 8, 9],
    wavenumber_min: 1.28,
    wavenumber_max: 2.63,
    margin: 3,
    exponent_cut: 14,
    wide_lobe_nodes: 20,
  }
  return makeMap('lobes', constants, [
    {
      name: 'lobe',
      bytes: halves(Array.from({ length: 3 * 4 * 8 * 4 }, () => 0.5)),
      dtype: 'float16',
      shape: [3, 4, 8, 4],
      axes: [
        axis('tint', 3, 'linear', 0, 2),
        axis('lobe width', 4, 'log', 0.004, 1),
        axis('position', 8, 'linear', 0, 1),
      ],
    },
    {
      name: 'weights',
      bytes: new Uint8Array(Float32Array.from({ length: 402 * 9 }, (_, i) => i / 3618).buffer),
      dtype: 'float32',
      shape: [402, 9],
      axes: [axis('wavelength', 402, 'linear', 0.3795, 0.7805)],
    },
  ])
}

export function fakeMetals(): FakeMap {
  return makeMap('metals', {}, [
    {
      name: 'reflectance',
      bytes: halves(Array.from({ length: 16 * 4 }, () => 0.9)),
      dtype: 'float16',
      shape: [1, 16, 4],
      axes: [axis('one', 1, 'linear', 0, 0), axis('wavenumber', 16, 'linear', 1.28, 2.63)],
    },
  ])
}

/** Two cells of a spectrum, as every map of a height field has them. */
function fakeCells(): FakeArray[] {
  const count = (length: number): number[] => Array.from({ length }, (_, i) => i / 64)
  return [
    {
      name: 'places',
      bytes: new Uint8Array(Float32Array.from(count(2 * 4)).buffer),
      dtype: 'float32',
      shape: [2, 4],
      axes: [axis('cell', 2, 'linear', 0, 1)],
    },
    {
      name: 'powers',
      bytes: new Uint8Array(Float32Array.from(count(2 * 3)).buffer),
      dtype: 'float32',
      shape: [2, 3, 1],
      axes: [axis('cell', 2, 'linear', 0, 1), axis('w/lambda', 3, 'linear', 0, 5.3)],
    },
  ]
}

/** What a map of height fields says that it was baked from, and which others with it. */
export const BAKED_RECIPE = {
  methods: ['jacobi-anger', 'baked'],
  roughness: 0.02,
  coherence: 16.25,
  illuminant: 'D65',
  metal: 'gold',
  tiles: null,
}

/** A baked pattern of one mode, for a roughness of 0.02 rad on gold. */
export function fakeBaked(): FakeMap {
  const constants = { modes: 1, u_max: 2, v_max: 2, angular_radius: 0 }
  const arrays: FakeArray[] = [
    {
      name: 'modes',
      bytes: halves(Array.from({ length: 3 * 4 * 4 * 4 }, () => 0.5)),
      dtype: 'float16',
      shape: [3, 4, 4, 4],
      axes: [
        axis('layer', 3, 'linear', 0, 2),
        axis('v', 4, 'linear', -2, 2),
        axis('u', 4, 'linear', -2, 2),
      ],
    },
    {
      name: 'weights',
      bytes: new Uint8Array(new Float32Array(8 * 4).buffer),
      dtype: 'float32',
      shape: [1, 8, 4],
      axes: [axis('group', 1, 'linear', 0, 0), axis('w', 8, 'linear', 0, 2)],
    },
    {
      name: 'coherent',
      bytes: halves(Array.from({ length: 3 * 8 * 4 }, () => 0.5)),
      dtype: 'float16',
      shape: [3, 8, 4],
      axes: [axis('distance over deviation', 3, 'linear', 0, 5), axis('w', 8, 'linear', 0, 2)],
    },
  ]
  return makeMap('height-field-baked', constants, [...arrays, ...fakeCells()], BAKED_RECIPE)
}

/** Five terms of a height field with 2 × 3 lines; every number is different. `recipe`: what the map says it was baked from. */
export function fakeTerms(recipe: object = {}): FakeMap {
  const count = (length: number): number[] => Array.from({ length }, (_, i) => i / 64)
  const constants = { period_x: 2, period_y: 3, amplitude: 0.1, max_phase: 4, terms: 5 }
  return makeMap(
    'height-field-terms',
    constants,
    [
      {
        name: 'terms',
        bytes: halves(count(3 * 3 * 2 * 4)),
        dtype: 'float16',
        shape: [3, 3, 2, 4],
        axes: [
          axis('pair', 3, 'linear', 0, 2),
          axis('line along y', 3, 'linear', -1, 1),
          axis('line along x', 2, 'linear', 0, 1),
        ],
      },
      {
        name: 'coefficients',
        bytes: new Uint8Array(Float32Array.from(count(5 * 4)).buffer),
        dtype: 'float32',
        shape: [5, 4, 1],
        axes: [axis('term', 5, 'linear', 0, 4), axis('x', 4, 'linear', 0, 4)],
      },
      ...fakeCells(),
    ],
    recipe,
  )
}

/** Slopes of a fake foil: value = STEEPEST (texel − 128)/127. */
export const STEEPEST = 0.1

/**
 * A foil of 2 × 2 texels, or another [width, height], as a PNG of 8 bits.
 *
 * @param normal - bumps: its pixels and their [width, height]
 */
export function fakeFoil(
  pixels = Uint8Array.from({ length: 16 }, (_, i) => 16 * i),
  [width, height]: [number, number] = [2, 2],
  normal?: { pixels: Uint8Array; size: [number, number] },
): FakeMap {
  const constants = { height_um: 0.1, min_frequency: 0.4, max_frequency: 0.8, tile_mm: [10, 10] }
  return makeMap(
    'foil',
    constants,
    [
      {
        name: 'grating',
        bytes: png(width, height, pixels),
        dtype: 'uint8',
        shape: [height, width, 4],
        decode: [
          [-1, 2],
          [-1, 2],
          [0, 0.8],
          [0, 1],
        ],
      },
      ...(normal
        ? [
            {
              name: 'normal',
              bytes: png(...normal.size, normal.pixels),
              dtype: 'uint8',
              shape: [normal.size[1], normal.size[0], 4],
              decode: [
                [(-STEEPEST * 128) / 127, (STEEPEST * 255) / 127],
                [(-STEEPEST * 128) / 127, (STEEPEST * 255) / 127],
                [0, 1],
                [0, 1],
              ],
            },
          ]
        : []),
    ],
    { profile: 'sinusoidal' },
  )
}

/** A PNG without row filters; `header` overrides bytes of IHDR: bit depth 8, colour type 9. */
export function png(
  width: number,
  height: number,
  pixels: Uint8Array,
  header: Record<number, number> = {},
): Uint8Array {
  const ihdr = new Uint8Array(13)
  const view = new DataView(ihdr.buffer)
  view.setUint32(0, width)
  view.setUint32(4, height)
  ihdr[8] = 8
  ihdr[9] = 6
  for (const [position, value] of Object.entries(header)) ihdr[Number(position)] = value
  const rows = new Uint8Array(height * (1 + 4 * width))
  for (let row = 0; row < height; row++)
    rows.set(pixels.subarray(row * 4 * width, (row + 1) * 4 * width), row * (1 + 4 * width) + 1)
  return pngOf(ihdr, rows)
}

/** A PNG of a header and of rows that bring their filter bytes. */
export function pngOf(ihdr: Uint8Array, rows: Uint8Array): Uint8Array {
  const signature = Uint8Array.of(0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a)
  return Buffer.concat([
    signature,
    chunk('IHDR', ihdr),
    chunk('IDAT', deflateSync(rows)),
    chunk('IEND', new Uint8Array()),
  ])
}

function chunk(type: string, data: Uint8Array): Uint8Array {
  const length = Buffer.alloc(4)
  length.writeUInt32BE(data.length)
  return Buffer.concat([length, Buffer.from(type, 'latin1'), data, Buffer.alloc(4)])
}

interface FakeArray {
  name: string
  bytes: Uint8Array
  dtype: string
  shape: number[]
  axes?: object[]
  decode?: number[][]
}

function makeMap(
  kind: string,
  constants: Record<string, number | number[]>,
  arrays: FakeArray[],
  recipe: object = {},
): FakeMap {
  const files: Record<string, Uint8Array> = {}
  const specs: Record<string, object> = {}
  for (const { name, bytes, shape, ...rest } of arrays) {
    const file = `${kind}.${name}.${rest.dtype === 'uint8' ? 'png' : 'bin'}`
    files[file] = bytes
    specs[name] = {
      file,
      shape,
      sha256: sha256(bytes),
      channels: Array.from({ length: shape.at(-1)! }, (_, i) => `channel ${i}`),
      ...rest,
    }
  }
  const sidecar = {
    format: 'three-diffraction/map',
    version: 1,
    kind,
    quantity: 'something',
    symbol: 'x',
    arrays: specs,
    constants,
    recipe,
  }
  return { sidecar, files }
}

export function sha256(bytes: Uint8Array): string {
  return createHash('sha256').update(bytes).digest('hex')
}

export function halves(values: number[]): Uint8Array {
  return new Uint8Array(Uint16Array.from(values, (v) => DataUtils.toHalfFloat(v)).buffer)
}

function axis(name: string, size: number, mapping: string, first: number, last: number): object {
  return { name, symbol: name[0], unit: '1', size, mapping, first, last }
}
