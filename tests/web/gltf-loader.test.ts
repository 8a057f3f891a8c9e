import { BoxGeometry, Mesh, MeshStandardMaterial } from 'three'
import { deflateSync } from 'node:zlib'
import { afterAll, afterEach, beforeAll, describe, expect, it, vi } from 'vitest'
import { DiffractionError } from '../../web/errors'
import { EXTENSION, type GLTFDiffractionLoaderOptions } from '../../web/gltf'
import { DiffractionMaterial } from '../../web/materials/DiffractionMaterial'
import { Grating } from '../../web/surfaces/grating'
import { DEEP, textOf } from './damage'
import { fakeFoil } from './fake-maps'
import { FAKES, fakeGlbs, serveFakes, type FakeName } from './gltf-fakes'
import {
  diffractingOf,
  exportGlb,
  foilOf,
  glbOf,
  load,
  materialsOf,
  partsOf,
  sceneOf,
  stubBrowser,
  type Json,
} from './gltf-files'

let files: Record<FakeName, ArrayBuffer>

beforeAll(async () => {
  stubBrowser()
  serveFakes()
  files = await fakeGlbs()
})

afterEach(() => {
  vi.restoreAllMocks()
})

afterAll(() => {
  vi.unstubAllGlobals()
})

interface Gltf {
  materials: (Json & { extensions: Record<string, Json> })[]
  extensions: Record<string, { maps: Json[] }>
  bufferViews: Json[]
  meshes: { primitives: { attributes: Json }[] }[]
}

/** A file after a change of its JSON. */
function changed(name: FakeName, change: (json: Gltf) => void): ArrayBuffer {
  const { json, binary } = partsOf(files[name])
  change(json as unknown as Gltf)
  return glbOf(JSON.stringify(json), binary)
}

/** What loading told of, and the materials that are shown. */
async function loaded(
  file: ArrayBuffer,
  options: GLTFDiffractionLoaderOptions = {},
  path = FAKES,
): Promise<{ errors: DiffractionError[]; diffracting: boolean[] }> {
  const errors: DiffractionError[] = []
  const onError = (error: DiffractionError): void => void errors.push(error)
  const gltf = await load(file, { mapsPath: FAKES, onError, ...options }, path)
  const diffracting = materialsOf(gltf).map((material) => material instanceof DiffractionMaterial)
  return { errors, diffracting }
}

const REFUSED = { diffracting: [false] }

describe('a map beside the file', () => {
  it.each([
    ...[
      'javascript:alert(1)//x.json',
      'JaVaScRiPt:x.json',
      'java\nscript:x.json',
      ' javascript:x.json',
    ],
    ...['data:application/json,{}.json', 'https://example.org/x.json', 'blob:x.json', 'C:x.json'],
    ...['//example.org/x.json', '/x.json', '\\\\example.org\\x.json', '\\x.json', 'a\\..\\x.json'],
    ...['x.json?y.json', 'x.json#y.json', 'x', '.json/', 'x.JSON', '\ud800.json', 'a\0.json', ''],
  ])('is not fetched from %j', async (uri) => {
    const fetched = vi.spyOn(globalThis, 'fetch')
    const file = changed('foil', ({ extensions }) => (extensions[EXTENSION]!.maps[0] = { uri }))
    const { errors, ...shown } = await loaded(file)
    expect(shown).toEqual(REFUSED)
    expect(errors).toMatchObject([{ file: `glTF in ${FAKES}`, value: uri }])
    expect(errors[0]!.field).toBe(`extensions.${EXTENSION}.maps[0].uri`)
    expect(fetched).not.toHaveBeenCalled()
  })

  it.each([
    ['./foil.json', FAKES],
    ['../gltf-fakes/foil.json', 'models/'],
  ])('is fetched from %s of %s', async (uri, path) => {
    const { fetch: served } = globalThis
    const fetched = vi.spyOn(globalThis, 'fetch').mockImplementation((address) => {
      const { href } = new URL(address as string, 'http://host/')
      return served(href.replace('http://host/', ''))
    })
    const file = changed('foil', ({ extensions }) => (extensions[EXTENSION]!.maps[0] = { uri }))
    expect(await loaded(file, {}, path)).toEqual({ errors: [], diffracting: [true] })
    expect(fetched).toHaveBeenCalledWith(path + uri)
  })

  it('that is not there is told by its own name', async () => {
    const maps = [{ uri: 'nothing.json' }]
    const file = changed('foil', ({ extensions }) => (extensions[EXTENSION] = { maps }))
    const { errors, ...shown } = await loaded(file)
    expect(shown).toEqual(REFUSED)
    expect(errors).toMatchObject([{ file: `${FAKES}nothing.json`, value: 'HTTP 404' }])
  })
})

describe('a hostile file', () => {
  it('does not have its images inflated further than they say', async () => {
    const png = Buffer.from(Object.values(fakeFoil().files)[0]!)
    // As long as a PNG of 2 × 2 texels may be.
    const idat = deflateSync(new Uint8Array(60 * 2 ** 20))
    const chunk = Buffer.alloc(12 + idat.length)
    chunk.writeUInt32BE(idat.length)
    chunk.write('IDAT', 4, 'latin1')
    idat.copy(chunk, 8)
    const bomb = Buffer.concat([png.subarray(0, png.indexOf('IDAT') - 4), chunk, png.subarray(-12)])
    const { json, binary } = partsOf(files.foil)
    const { extensions, bufferViews } = json as unknown as Gltf
    const { grating } = extensions[EXTENSION]!.maps[0]!.arrays as { grating: Json }
    grating.bufferView = bufferViews.length
    bufferViews.push({ buffer: 0, byteOffset: binary.length, byteLength: bomb.length })
    const glb = glbOf(JSON.stringify(json), Buffer.concat([binary, bomb]))
    const { errors, ...shown } = await loaded(glb)
    expect(shown).toEqual(REFUSED)
    const field = `extensions.${EXTENSION}.maps[0].arrays.grating.IDAT bytes`
    expect(errors).toMatchObject([{ field, value: 'more' }])
  })

  it('cannot ask for more memory by asking often', async () => {
    const { json, binary } = partsOf(files.foil)
    const { materials, extensions, meshes } = json as unknown as Gltf
    const { maps } = extensions[EXTENSION]!
    for (let i = 1; i < 20; i++) {
      maps.push(maps[0]!)
      const material = structuredClone(materials[0]!)
      ;(material.extensions[EXTENSION]!.surface as Json).map = i
      materials.push(material)
      meshes[0]!.primitives.push({ ...meshes[0]!.primitives[0]!, material: i } as never)
    }
    const glb = glbOf(JSON.stringify(json), binary)
    // Of 2 × 2 texels of 4 bytes.
    const { errors, diffracting } = await loaded(glb, { maxMapBytes: 16 * 5 })
    expect(diffracting.filter(Boolean)).toHaveLength(5)
    expect(errors).toHaveLength(15)
    for (const { field, expected } of errors) {
      expect(field).toMatch(/\.maps\[\d+\]\.arrays\.grating\.shape$/)
      expect(expected).toContain('80 bytes')
    }
  })

  it('is not followed into lists within lists', async () => {
    for (const [place, field] of [
      [(json: Gltf) => json.extensions[EXTENSION]!.maps[0]!.arrays, 'grating.bufferView'],
      [(json: Gltf) => json.extensions[EXTENSION]!.maps[0]!, 'recipe.profile'],
      [(json: Gltf) => json.materials[0]!.extensions[EXTENSION]!, 'surface.map'],
      [(json: Gltf) => json.materials[0]!.extensions[EXTENSION]!, 'surface.repeat'],
    ] as const) {
      const { json, binary } = partsOf(files.foil)
      const [owner, name] = field.split('.') as [string, string]
      const object = (place(json as unknown as Gltf) as Record<string, Json>)[owner]!
      object[name] = DEEP
      const { errors, ...shown } = await loaded(glbOf(textOf(json), binary))
      expect(shown, field).toEqual(REFUSED)
      expect(errors[0]!.field).toContain(field.startsWith('recipe') ? 'recipe' : field)
    }
  })

  it('puts nothing into shaders by way of a texture', async () => {
    for (const texCoord of ['0; discard', 1e9, 0.5, -1]) {
      const file = changed('grating', ({ materials }) => {
        materials[0]!.extensions[EXTENSION]!.matteColorTexture = { index: 0, texCoord }
      })
      const { errors, ...shown } = await loaded(file)
      expect(shown).toEqual(REFUSED)
      expect(errors[0]!.field).toMatch(/matteColorTexture\.texCoord$/)
    }
  })

  it('costs the material that is wrong, and no other', async () => {
    const scene = sceneOf(new DiffractionMaterial({ mapsPath: FAKES, surface: grating() }))
    const other = new DiffractionMaterial({ mapsPath: FAKES, surface: grating(), metal: 'gold' })
    scene.add(new Mesh(new BoxGeometry(), other))
    const { json, binary } = partsOf(await exportGlb(scene))
    const { materials } = json as unknown as Gltf
    ;(materials[0]!.extensions[EXTENSION]!.surface as Json).period = -1
    const { errors, diffracting } = await loaded(glbOf(JSON.stringify(json), binary))
    expect(errors).toHaveLength(1)
    expect(diffracting).toEqual([false, true])
  })
})

describe('what is told', () => {
  const broken = (): ArrayBuffer =>
    changed('grating', ({ materials }) => (materials[0]!.extensions[EXTENSION] = {}))

  it('goes to the console by default', async () => {
    const log = vi.spyOn(console, 'error').mockImplementation(() => undefined)
    const [material] = materialsOf(await load(broken(), { mapsPath: FAKES }))
    expect(material).toBeInstanceOf(MeshStandardMaterial)
    expect(log).toHaveBeenCalledExactlyOnceWith(expect.any(DiffractionError))
  })

  it('ends the loading where onError throws it', async () => {
    const onError = (error: DiffractionError): void => {
      throw error
    }
    await expect(load(broken(), { mapsPath: FAKES, onError })).rejects.toBeInstanceOf(
      DiffractionError,
    )
  })

  it('is what happens to a material later on', async () => {
    const { errors, onError } = collector()
    const [material] = await diffractingOf(await load(files.grating, { mapsPath: FAKES, onError }))
    material!.illuminant = 'candle'
    await material!.ready.catch(() => undefined)
    expect(errors).toMatchObject([{ file: `${FAKES}lobes-1931-2-candle.json` }])
  })
})

describe('a material', () => {
  it('has no directions without texture coordinates', async () => {
    const file = changed('grating', ({ meshes }) => {
      Reflect.deleteProperty(meshes[0]!.primitives[0]!.attributes, 'TEXCOORD_0')
    })
    const { errors, ...shown } = await loaded(file)
    expect(shown).toEqual(REFUSED)
    expect(errors).toMatchObject([{ field: 'meshes[0].primitives[0].attributes.TEXCOORD_0' }])
  })

  it.each<[string, (material: Json & { extensions: Json }) => void]>([
    ['extensions.KHR_materials_unlit', ({ extensions }) => (extensions.KHR_materials_unlit = {})],
    ['alphaMode', (material) => (material.alphaMode = 'MASK')],
  ])('is not drawn with %s', async (field, change) => {
    const file = changed('grating', (json) => {
      change(json.materials[0]!)
      Object.assign(json, { extensionsUsed: [EXTENSION, 'KHR_materials_unlit'] })
    })
    const { errors, ...shown } = await loaded(file)
    expect(shown).toEqual(REFUSED)
    expect(errors).toMatchObject([{ field: `materials[0].${field}` }])
  })

  it('is drawn by defaults where hints are passed over', async () => {
    const options = { mapsPath: FAKES, rendering: false }
    const [material] = await diffractingOf(await load(files.grating, options))
    expect(material).toMatchObject({ method: 'closed-form', environmentNodes: 12, gamut: 'map' })
    expect(material).toMatchObject({ coat: 0.5, lightAngularRadius: 0.01 })
  })

  it('shares its maps with the others of its file, and with no other file', async () => {
    const [first] = await diffractingOf(await load(files.foil, { mapsPath: FAKES }))
    const [again] = await diffractingOf(await load(files.foil, { mapsPath: FAKES }))
    expect(foilOf(first!).map).not.toBe(foilOf(again!).map)
    expect(foilOf(first!).map).toBe(foilOf(first!.clone()).map)
  })
})

function grating(): Grating {
  return new Grating({ period: 1.5, height: 0.1 })
}

function collector(): { errors: DiffractionError[]; onError: (error: DiffractionError) => void } {
  const errors: DiffractionError[] = []
  return { errors, onError: (error) => void errors.push(error) }
}
