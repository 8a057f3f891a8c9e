/**
 * Damaged and hostile maps: each is refused by a typed error, or is the map that it states.
 *
 * `FUZZ_MAPS=100000 npx vitest run --project web fuzz-maps`
 */

import { crc32, deflateSync } from 'node:zlib'
import { afterEach, expect, it, vi } from 'vitest'
import { DiffractionError } from '../../web/errors'
import { loadMap, valuesOf, type LoadedMap } from '../../web/maps/load'
import {
  below,
  damagedBytes,
  damageFields,
  HOSTILE,
  pick,
  randomOf,
  textOf,
  type Json,
  type Random,
} from './damage'
import { fakeFoil, fakeLobes, fakeProfile, sha256, type FakeMap } from './fake-maps'

const COUNT = Number(process.env.FUZZ_MAPS ?? 3000)
const MAX_SECONDS = 2
const MAX_GROWTH_BYTES = 256 * 2 ** 20
const FOLDER = 'http://host/maps/'

type Files = Record<string, Uint8Array>

/** Values for fields of sidecars, names of files among them. */
const HOSTILE_FIELDS: unknown[] = [
  ...HOSTILE,
  ...[[2 ** 32, 2 ** 32, 4], [2 ** 62, 4, 4], [8192, 8192, 4], Array<number>(65).fill(1)],
  ...['../foil.grating.png', '/etc/passwd', 'C:\\x.bin', '..\\x.bin', 'a/../x.bin', './x.bin'],
  ...['https://example.org/x.bin', '//example.org/x.bin', 'file:///x.bin', 'data:,x.bin'],
  ...[
    '%2e%2e%2fx.bin',
    '%2e%2e',
    'x.bin?y',
    'x.bin#y.bin',
    'a\0.bin',
    'a\n.bin',
    '.',
    '..',
    '.bin',
  ],
  ...['\ud800.bin', ' ', 'x.png', 'float16', 'float32', 'uint8', 'linear', 'square', 'log'],
]

afterEach(() => {
  vi.unstubAllGlobals()
})

const bytesOf = (sidecar: Json): Uint8Array => new TextEncoder().encode(textOf(sidecar))

function specsOf(sidecar: Json): Json[] {
  return Object.values(sidecar.arrays as Record<string, Json>)
}

/** The files, with the checksums of what is there, so that the damage is looked at behind them. */
function signed(sidecar: Json, binaries: Files): Files {
  for (const spec of specsOf(sidecar)) spec.sha256 = sha256(binaries[spec.file as string]!)
  return { ...binaries, 'x.json': bytesOf(sidecar) }
}

function damagedFile({ sidecar, files }: FakeMap, random: Random): Files {
  const all: Files = { ...files, 'x.json': bytesOf(sidecar) }
  const name = pick(random, Object.keys(all))
  const damaged = { ...all, [name]: damagedBytes(all[name]!, Object.values(all), random) }
  return name === 'x.json' || random() < 0.2 ? damaged : signed(sidecar, damaged)
}

function damagedField({ sidecar, files }: FakeMap, random: Random): Files {
  damageFields(sidecar, HOSTILE_FIELDS, random)
  return { ...files, 'x.json': bytesOf(sidecar) }
}

function damagedFileName({ sidecar, files }: FakeMap, random: Random): Files {
  const names = HOSTILE_FIELDS.filter((value) => typeof value === 'string')
  pick(random, specsOf(sidecar)).file = pick(random, names)
  return { ...files, 'x.json': bytesOf(sidecar) }
}

const BOMB = deflateSync(new Uint8Array(64 * 2 ** 20))
const SIZES = [0, 1, 2, 7, 64, 4096, 8192, 16384, 65536, 2 ** 31 - 1, 2 ** 32 - 1]

/** Chunks that are wrong, with checksums that are right. */
function damagedImage(map: FakeMap, random: Random): Files {
  const [name, bytes] = Object.entries(map.files)[0]!
  if (!name.endsWith('.png')) return damagedFile(map, random)
  const data = Buffer.from(bytes)
  const chunks: { type: Uint8Array; body: Uint8Array }[] = []
  for (let at = 8; at < data.length;) {
    const length = data.readUInt32BE(at)
    chunks.push({
      type: data.subarray(at + 4, at + 8),
      body: Uint8Array.from(data.subarray(at + 8, at + 8 + length)),
    })
    at += 12 + length
  }
  for (let i = below(random, 2); i >= 0; i--) {
    const target = pick(random, chunks)
    const header = chunks[0]!
    const noise = Uint8Array.from({ length: pick(random, [16, 17, 18, 19, 100_000]) }, () =>
      below(random, 6),
    )
    switch (below(random, 6)) {
      case 0: {
        const size = [pick(random, SIZES), pick(random, SIZES)]
        const ihdr = Buffer.from(header.body.length < 13 ? new Uint8Array(13) : header.body)
        ihdr.writeUInt32BE(size[0]!, 0)
        ihdr.writeUInt32BE(size[1]!, 4)
        header.body = ihdr
        if (random() < 0.5) specsOf(map.sidecar)[0]!.shape = [size[1], size[0], 4]
        break
      }
      case 1:
        if (header.body.length > 8) header.body[8 + below(random, 5)] = below(random, 256)
        break
      case 2:
        target.type = Buffer.from('IDAT')
        target.body = random() < 0.1 ? BOMB : deflateSync(noise)
        break
      case 3:
        target.body = target.body.subarray(0, below(random, target.body.length + 1))
        break
      case 4:
        chunks.splice(below(random, chunks.length), 0, { ...target })
        break
      default:
        target.type = noise.subarray(0, 4)
    }
  }
  const parts = chunks.map(({ type, body }) => {
    const chunk = Buffer.concat([new Uint8Array(4), type, body, new Uint8Array(4)])
    chunk.writeUInt32BE(body.length, 0)
    chunk.writeUInt32BE(crc32(chunk.subarray(4, -4)), chunk.length - 4)
    return chunk
  })
  return signed(map.sidecar, { [name]: Buffer.concat([data.subarray(0, 8), ...parts]) })
}

const MAPS = [fakeProfile(), fakeFoil(), fakeLobes(), fakeFoil()]
const DAMAGES = [damagedFile, damagedField, damagedFileName, damagedImage]

/** Every number is finite, there are as many as the shape has, and those of binaries are the ones in the files. */
function expectAsStated(map: LoadedMap, files: Files): void {
  const stated = JSON.parse(new TextDecoder().decode(files['x.json'])) as Json
  expect(map.sidecar.kind).toBe(stated.kind)
  expect(Object.keys(map.arrays).sort()).toEqual(Object.keys(stated.arrays as object).sort())
  for (const [name, numbers] of Object.entries(map.sidecar.constants))
    expect(numbers).toEqual([(stated.constants as Json)[name]].flat())
  for (const [name, array] of Object.entries(map.arrays)) {
    const spec = (stated.arrays as Record<string, Json>)[name]!
    const shape = spec.shape as number[]
    expect(array.data.length).toBe(shape.reduce((product, size) => product * size))
    expect(valuesOf(array).every(Number.isFinite)).toBe(true)
    if (spec.dtype !== 'uint8')
      expect(Buffer.from(array.data.buffer).equals(files[spec.file as string]!)).toBe(true)
  }
}

it(
  `refuses ${COUNT} damaged maps, or loads what they state`,
  async () => {
    let files: Files = {}
    vi.stubGlobal('fetch', (url: string) => {
      // As a browser and a server would find it.
      const { href } = new URL(url)
      if (!href.startsWith(FOLDER)) throw new Error(`left its folder: ${href}`)
      const body = files[decodeURIComponent(href.slice(FOLDER.length))]
      return Promise.resolve(new Response(body as BodyInit, { status: body ? 200 : 404 }))
    })
    const before = process.memoryUsage().rss
    const start = performance.now()
    let [refused, slowest, growth] = [0, 0, 0]
    for (let seed = 0; seed < COUNT; seed++) {
      const random = randomOf(seed)
      const whole = structuredClone(pick(random, MAPS))
      files = DAMAGES[seed % DAMAGES.length]!(whole, random)
      const begin = performance.now()
      const outcome: unknown = await loadMap(`${FOLDER}x`).catch((error: unknown) => error)
      slowest = Math.max(slowest, (performance.now() - begin) / 1000)
      growth = Math.max(growth, process.memoryUsage().rss - before)
      if (outcome instanceof DiffractionError && !outcome.message.includes('left its folder'))
        refused++
      else if (outcome instanceof Error) throw new Error(`seed ${seed}`, { cause: outcome })
      else expectAsStated(outcome as LoadedMap, files)
      expect(slowest, `seconds for seed ${seed}`).toBeLessThan(MAX_SECONDS)
    }
    console.log(
      `${COUNT} maps in ${((performance.now() - start) / 1000).toFixed(0)} s: ${refused} refused, ` +
        `${COUNT - refused} valid; slowest ${slowest.toFixed(3)} s, memory grew by ${(growth / 2 ** 20).toFixed(0)} MB`,
    )
    expect(growth).toBeLessThan(MAX_GROWTH_BYTES)
    expect(refused).toBeGreaterThan(0)
    expect(refused).toBeLessThan(COUNT)
  },
  Math.max(30_000, COUNT * 20),
)
