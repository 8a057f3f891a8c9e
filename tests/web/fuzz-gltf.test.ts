/**
 * Damaged and hostile glTF files: the extension is shown as it states, or refused by one typed error and shown as plain metal;
 * what is damaged beside it is three's loader's to refuse.
 *
 * `FUZZ_GLTF=100000 npx vitest run --project web fuzz-gltf`
 */

import { DataTexture, MeshStandardMaterial, type Group } from 'three'
import { afterAll, beforeAll, expect, it, vi } from 'vitest'
import { DiffractionError } from '../../web/errors'
import { EXTENSION } from '../../web/gltf'
import { tableOf } from '../../web/gltf/tables'
import { DiffractionMaterial } from '../../web/materials/DiffractionMaterial'
import {
  damagedBytes,
  damageFields,
  HOSTILE,
  pick,
  randomOf,
  textOf,
  type Json,
  type Random,
} from './damage'
import { FAKES, fakeGlbs, serveFakes } from './gltf-fakes'
import { glbOf, load, materialsOf, partsOf, stubBrowser } from './gltf-files'

const COUNT = Number(process.env.FUZZ_GLTF ?? 2500)
const MAX_SECONDS = 2
const MAX_GROWTH_BYTES = 256 * 2 ** 20

/** Values for fields of the extension, addresses among them. */
const HOSTILE_FIELDS: unknown[] = [
  ...HOSTILE,
  ...[[2 ** 32, 2 ** 32, 4], [8192, 8192, 4], [4096, 4096, 4], Array<number>(65).fill(1)],
  ...['javascript:alert(1)//x.json', 'data:,{}.json', 'https://example.org/x.json', '/etc/x.json'],
  ...[
    '//example.org/x.json',
    '\\\\example.org\\x.json',
    'file:///x.json',
    'x.json?y.json',
    'x.json',
  ],
  ...['java\nscript:x.json', '../gltf-fakes/foil.json', 'foil.json', 'a\0.json', '\ud800.json'],
  ...['grating', 'foil', 'heightField', 'sinusoidal', '..\\x', '%2e%2e%2fx', 'D65', 'gold'],
  ...['line-sum', 'baked', 'taylor', 'wavelength-loop', 'float16', 'float32', 'uint8', 'log'],
  ...['profile', 'lobes', 'metals', 'height-field-terms', 'height-field-baked', 1e-300, 2 ** -30],
  ...[
    { uri: 'javascript:x.json' },
    { uri: 'foil.json' },
    { index: 0 },
    { index: 0, texCoord: '0;' },
  ],
]

let glbs: ArrayBuffer[]

beforeAll(async () => {
  stubBrowser()
  serveFakes()
  glbs = Object.values(await fakeGlbs())
  const { fetch: served } = globalThis
  vi.stubGlobal('fetch', (address: string | Request) => {
    // What three's loader asks for by itself.
    if (typeof address !== 'string') return served(address)
    // As a browser would find it.
    const { href } = new URL(address, 'http://host/')
    if (!href.startsWith(`http://host/${FAKES}`)) throw new Error(`left its folder: ${href}`)
    return served(address)
  })
  // three's loader says much of what it cannot read; a spy would keep it all.
  const silent = (): void => undefined
  vi.stubGlobal('console', { ...console, error: silent, warn: silent })
})

// three's loader leaves promises behind where another one has failed before.
const unhandled = process.listeners('unhandledRejection')
beforeAll(() => {
  process.removeAllListeners('unhandledRejection')
  process.on('unhandledRejection', (error: Error) => {
    if (!/three[\\/]examples/.test(error.stack ?? '')) throw error
  })
})

afterAll(() => {
  process.removeAllListeners('unhandledRejection')
  for (const listener of unhandled) process.on('unhandledRejection', listener)
  vi.unstubAllGlobals()
})

interface Parts {
  json: Json
  binary: Uint8Array
}
/** A damaged file, and whether nothing but the extension and what it refers to was damaged. */
type Damage = (parts: Parts, random: Random) => { file: ArrayBuffer; isOurs: boolean }

const fileOf = ({ json, binary }: Parts): ArrayBuffer => glbOf(textOf(json), binary)

function damagedMaterial(parts: Parts, random: Random): ReturnType<Damage> {
  const [material] = parts.json.materials as { extensions: Json }[]
  damageFields(material!.extensions[EXTENSION] as Json, HOSTILE_FIELDS, random)
  return { file: fileOf(parts), isOurs: true }
}

function damagedMaps(parts: Parts, random: Random): ReturnType<Damage> {
  const extensions = parts.json.extensions as Json | undefined
  if (extensions === undefined) return damagedMaterial(parts, random)
  damageFields(extensions[EXTENSION] as Json, HOSTILE_FIELDS, random)
  return { file: fileOf(parts), isOurs: true }
}

/** Bytes of one of its buffer views, in its place. */
function damagedArray({ json, binary }: Parts, random: Random): ReturnType<Damage> {
  const extensions = json.extensions as Record<string, { maps: Json[] }> | undefined
  if (extensions === undefined) return damagedMaterial({ json, binary }, random)
  const { arrays } = pick(random, extensions[EXTENSION]!.maps)
  const { bufferView } = pick(
    random,
    Object.values(arrays as Record<string, { bufferView: number }>),
  )
  const views = json.bufferViews as { byteOffset: number; byteLength: number }[]
  const { byteOffset, byteLength } = views[bufferView]!
  const whole = binary.slice(byteOffset, byteOffset + byteLength)
  const damaged = damagedBytes(whole, [binary], random)
  if (random() < 0.5) {
    binary.set(damaged.subarray(0, byteLength), byteOffset)
    return { file: fileOf({ json, binary }), isOurs: true }
  }
  // At the end, with a length of its own.
  views[bufferView] = { byteOffset: binary.length, byteLength: damaged.length, buffer: 0 } as never
  const longer = new Uint8Array(binary.length + damaged.length)
  longer.set(binary)
  longer.set(damaged, binary.length)
  return { file: fileOf({ json, binary: longer }), isOurs: true }
}

/** Accessors and nodes, of which a loader can make what it likes without us, are left as they are. */
function damagedGltf({ json, binary }: Parts, random: Random): ReturnType<Damage> {
  const { accessors, nodes, scenes, scene, ...rest } = json
  damageFields(rest, HOSTILE_FIELDS, random)
  return {
    file: fileOf({ json: { accessors, nodes, scenes, scene, ...rest }, binary }),
    isOurs: false,
  }
}

function damagedContainer(parts: Parts, random: Random): ReturnType<Damage> {
  const whole = new Uint8Array(fileOf(parts))
  return { file: damagedBytes(whole, [whole], random).slice().buffer, isOurs: false }
}

const DAMAGES: Damage[] = [
  damagedMaterial,
  damagedMaps,
  damagedArray,
  damagedGltf,
  damagedContainer,
]

/** What was shown: as stated, as plain metal, or nothing. */
async function outcomeOf(
  file: ArrayBuffer,
  isOurs: boolean,
): Promise<'shown' | 'refused' | 'unread'> {
  const errors: unknown[] = []
  const onError = (error: unknown): void => void errors.push(error)
  const gltf: unknown = await load(file, { mapsPath: FAKES, onError }, FAKES).catch(
    (error: unknown) => error,
  )
  for (const error of errors) {
    expect(error).toBeInstanceOf(DiffractionError)
    expect((error as DiffractionError).message).not.toContain('left its folder')
    // What was not foreseen is told under that name.
    expect((error as DiffractionError).field, String(error)).not.toBe('tables')
  }
  if (gltf instanceof Error) {
    // A field of a hostile name may not even be JSON.
    if (isOurs && !(gltf instanceof SyntaxError)) throw gltf
    return 'unread'
  }
  // Damaged by name or number, there may be no scene.
  const { scene } = gltf as { scene?: Group }
  if (scene === undefined && !isOurs) return 'unread'
  const materials = materialsOf({ scene: scene! })
  const diffracting = materials.filter((material) => material instanceof DiffractionMaterial)
  expect(errors.length).toBeLessThanOrEqual(1)
  if (isOurs) expect(errors.length + diffracting.length).toBe(1)
  for (const material of materials)
    if (material instanceof DiffractionMaterial) await expectDrawable(material)
    else if (errors.length > 0) expect(material).toBeInstanceOf(MeshStandardMaterial)
  return diffracting.length > 0 ? 'shown' : 'refused'
}

/** What never settles is waited for as long as what is slow. */
async function withinTime<T>(outcome: Promise<T>): Promise<T> {
  let timer: NodeJS.Timeout | undefined
  const late = new Promise<never>((_, reject) => {
    timer = setTimeout(() => {
      reject(new Error('It does not settle'))
    }, 1000 * MAX_SECONDS)
  })
  return Promise.race([outcome, late]).finally(() => {
    clearTimeout(timer)
  })
}

async function expectDrawable(material: DiffractionMaterial): Promise<void> {
  await material.ready
  for (const [name, value] of Object.entries(material.defines))
    expect(String(value), name).toMatch(/^[\w.+-]*$/)
  const {
    MAX_ORDER = 0,
    LIGHT_NODES = 0,
    ENVIRONMENT_NODES = 0,
  } = material.defines as Record<string, number>
  expect(MAX_ORDER).toBeLessThan(2048)
  expect(LIGHT_NODES).toBeLessThan(4002)
  expect(ENVIRONMENT_NODES).toBeLessThan(402)
  // What an environment and a lamp would ask for.
  const tables = Object.entries(material.surface.tables(material, material.mapsPath))
  const maps = tables.map(async ([name, url]) => [name, await tableOf(material, url)] as const)
  const optics = material.surface.optics(Object.fromEntries(await Promise.all(maps)), material)
  optics.underLights(0.01)
  for (const { value } of Object.values(optics.environmentUniforms()) as { value: unknown }[])
    if (value instanceof DataTexture) expect(value.image.data!.length).toBeLessThan(2 ** 22)
}

it(
  `shows ${COUNT} damaged files as they state, or as plain metal`,
  async () => {
    const prototype = Object.getOwnPropertyNames(Object.prototype)
    const before = process.memoryUsage().rss
    const start = performance.now()
    const outcomes = { shown: 0, refused: 0, unread: 0 }
    let [slowest, growth] = [0, 0]
    for (let seed = 0; seed < COUNT; seed++) {
      const random = randomOf(seed)
      const { json, binary } = partsOf(pick(random, glbs))
      const parts = { json: structuredClone(json), binary: binary.slice() }
      const { file, isOurs } = DAMAGES[seed % DAMAGES.length]!(parts, random)
      const begin = performance.now()
      try {
        outcomes[await withinTime(outcomeOf(file, isOurs))]++
      } catch (cause) {
        throw new Error(`seed ${seed}`, { cause })
      }
      slowest = Math.max(slowest, (performance.now() - begin) / 1000)
      growth = Math.max(growth, process.memoryUsage().rss - before)
      expect(slowest, `seconds for seed ${seed}`).toBeLessThan(MAX_SECONDS)
    }
    console.log(
      `${COUNT} files in ${((performance.now() - start) / 1000).toFixed(0)} s: ${JSON.stringify(outcomes)}; ` +
        `slowest ${slowest.toFixed(3)} s, memory grew by ${(growth / 2 ** 20).toFixed(0)} MB`,
    )
    expect(growth).toBeLessThan(MAX_GROWTH_BYTES)
    expect(Object.getOwnPropertyNames(Object.prototype)).toEqual(prototype)
    for (const [outcome, count] of Object.entries(outcomes))
      expect(count, outcome).toBeGreaterThan(0)
  },
  Math.max(60_000, COUNT * 20),
)
