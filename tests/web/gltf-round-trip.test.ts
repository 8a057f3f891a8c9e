import {
  BoxGeometry,
  DirectionalLight,
  DoubleSide,
  Group,
  Mesh,
  MeshPhysicalMaterial,
  MeshStandardMaterial,
  Scene,
  Vector2,
} from 'three'
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js'
import { validateBytes } from 'gltf-validator'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { DiffractionError } from '../../web/errors'
import { EXTENSION, GLTFDiffractionExporterPlugin } from '../../web/gltf'
import { loadMap, type LoadedMap } from '../../web/maps/load'
import { DiffractionMaterial } from '../../web/materials/DiffractionMaterial'
import type { DiffractionMaterialOptions } from '../../web/materials/options'
import { Foil } from '../../web/surfaces/foil'
import { Grating } from '../../web/surfaces/grating'
import { HeightField, type HeightFieldOptions } from '../../web/surfaces/height-field'
import { PROFILES } from '../../web/surfaces/profile'
import type { Surface } from '../../web/surfaces/surface'
import { fakeFoil, filesOf, serveFiles } from './fake-maps'
import { serveBakedMaps } from './baked-maps'
import {
  diffractingOf,
  exportGlb,
  exportJson,
  foilOf,
  load,
  materialsOf,
  partsOf,
  sceneOf,
  serveData,
  stubBrowser,
  type Json,
} from './gltf-files'
import { schemaErrors } from './gltf-schema'
import { mapState, stateOf } from './gltf-state'

beforeEach(() => {
  stubBrowser()
  serveBakedMaps()
  serveData()
})

afterEach(() => {
  vi.unstubAllGlobals()
})

const BAKED = 'maps/baked/'
/** Of foils with few gratings and with many. */
const [FEW, MANY] = [`${BAKED}foil-polygons`, `${BAKED}foil-glitter`]

const grating = (options: object): Surface => new Grating({ period: 1.5, height: 0.11, ...options })
const field = (options: HeightFieldOptions): Surface => new HeightField(options)
const repeat = new Vector2(3, -0.25)

type Case = (options: Partial<DiffractionMaterialOptions>) => Promise<DiffractionMaterial>
const caseOf =
  (
    surface: () => Surface | Promise<Surface>,
    own: Partial<DiffractionMaterialOptions> = {},
  ): Case =>
  async (options) =>
    new DiffractionMaterial({ surface: await surface(), ...own, ...options })

const CASES: Record<string, Case> = {
  ...Object.fromEntries(
    PROFILES.map((profile) => [`grating, ${profile}`, caseOf(() => grating({ profile }))]),
  ),
  'grating, circular': caseOf(() => grating({ tracks: 'circular', orientation: -0.7 })),
  'grating, partial': caseOf(() => grating({ orientation: 1 / 3, strength: 0.3 })),
  'grating of a profile by address': caseOf(() => grating({ profile: `${BAKED}profile-blazed` })),
  'foil of few gratings': caseOf(() => Foil.load(FEW)),
  'foil of many gratings': caseOf(() =>
    Foil.load(MANY, { repeat, height: 0.2, filtered: false, profile: 'triangular' }),
  ),
  'height field': caseOf(() => field({ field: 'cosine' })),
  'height field, patches': caseOf(() => field({ field: 'cosine', tiles: [3, 8] })),
  'height field of skin': caseOf(() =>
    field({ field: 'fingers', ior: 1.44, strength: 0.6, orientation: 0.2 }),
  ),
  'height field by Taylor': caseOf(() => field({ field: 'blazed' }), {
    method: 'taylor',
    wavelengthStep: 0.01,
  }),
  'height field, baked': caseOf(() => field({ field: 'bumps' }), {
    method: 'baked',
    roughness: 0.0175,
  }),
}

/** Every option that is not a table, a texture or the surface, as it is by none's default. */
const EVERYTHING: Partial<DiffractionMaterialOptions> = {
  metal: 'gold',
  observer: '2015-2',
  energy: 'kirchhoff',
  roughness: 0.021,
  coherence: 9.5,
  lightAngularRadius: 0.0047,
  coat: 0.8,
  coatIor: 1.7,
  coatRoughness: 0.3,
  color: 0x336699,
  gamut: 'signed',
  planarEnvironment: false,
  diffraction: false,
  method: 'wavelength-loop',
  efficiencies: 'taylor',
  wavelengthStep: 0.004,
  environmentNodes: 24,
  name: 'foil & <b>',
  side: DoubleSide,
  transparent: true,
  opacity: 0.75,
}

const containers = { glb: exportGlb, gltf: exportJson }

async function roundTrip(
  material: DiffractionMaterial,
  container: keyof typeof containers = 'glb',
): Promise<DiffractionMaterial> {
  const [back] = await diffractingOf(await load(await containers[container](sceneOf(material))))
  return back!
}

describe.each(Object.keys(containers) as (keyof typeof containers)[])('a %s', (container) => {
  it.each(Object.entries(CASES))('brings back a %s', async (_name, make) => {
    const material = await make({})
    await material.ready
    const back = await roundTrip(material, container)
    expect(await stateOf(back)).toEqual(await stateOf(material))
    expect(back.defines).toEqual(material.defines)
  })
})

describe('what is in a file', () => {
  it('is every option', async () => {
    const surface = grating({})
    const material = new DiffractionMaterial({ surface, ...EVERYTHING })
    material.userData = { note: 'mine' }
    const [state, defaults] = await Promise.all(
      [material, new DiffractionMaterial({ surface })].map(stateOf),
    )
    for (const [name, value] of Object.entries(state!))
      if (!['surface', 'maxError', 'illuminant'].includes(name))
        expect(value, name).not.toEqual(defaults![name as keyof typeof defaults])
    expect(await stateOf(await roundTrip(material))).toEqual(state)
  })

  it('is the largest error in the place of what it chose', async () => {
    const material = new DiffractionMaterial({
      surface: field({ field: 'bumps' }),
      maxError: 0.02,
      environmentNodes: 20,
    })
    await material.ready
    const back = await roundTrip(material)
    expect(await stateOf(back)).toEqual(await stateOf(material))
    expect([...back.given]).not.toContain('method')
    // What is in the file: the map knows of a baked one too, but it was baked for a rough surface.
    const known = ['jacobi-anger', 'taylor']
    for (const map of Object.values(back.maps)) expect(map.sidecar.recipe.methods).toEqual(known)
  })

  it('is an illuminant by name or as a map', async () => {
    const named = new DiffractionMaterial({ surface: grating({}), illuminant: 'LED-B3' })
    expect((await roundTrip(named)).illuminant).toBe('LED-B3')
    const lobes = await loadMap(`${BAKED}lobes-1931-2-A`)
    for (const options of [
      { illuminant: `${BAKED}lobes-1931-2-A` },
      { illuminant: 'my/lamp', maps: { 'my/lamp': lobes } },
    ]) {
      const material = new DiffractionMaterial({ surface: grating({}), ...options })
      const back = await roundTrip(material)
      expect(mapState(back.maps[back.illuminant]!)).toEqual(mapState(lobes))
    }
  })

  it('is each map once, whoever shows it', async () => {
    const foil = await Foil.load(FEW)
    const scene = new Scene()
    for (const metal of ['gold', 'silver'] as const)
      scene.add(new Mesh(new BoxGeometry(), new DiffractionMaterial({ surface: foil, metal })))
    const glb = await exportGlb(scene)
    expect(rootOf(partsOf(glb).json).maps).toHaveLength(1)
    const [gold, silver] = await diffractingOf(await load(glb))
    expect([gold!.metal, silver!.metal]).toEqual(['gold', 'silver'])
    expect(foilOf(gold!).map).toBe(foilOf(silver!).map)
  })

  it('are bumps of a foil with its gratings', async () => {
    const pixels = Uint8Array.from({ length: 36 }, (_, i) => 7 * i)
    serveFiles(filesOf({ 'bumpy/foil': fakeFoil(undefined, [2, 2], { pixels, size: [3, 3] }) }))
    const foil = await Foil.load('bumpy/foil')
    serveBakedMaps()
    serveData()
    const back = foilOf(await roundTrip(new DiffractionMaterial({ surface: foil })))
    expect(back.hasBumps).toBe(true)
    expect(mapState(back.map)).toEqual(mapState(foil.map))
  })

  it('is where a map lies, if it is not to be in the file', async () => {
    const uriOf = ({ url }: LoadedMap): string => `${url.slice(BAKED.length)}.json`
    const material = new DiffractionMaterial({ surface: await Foil.load(FEW) })
    const json = await exportJson(sceneOf(material), { uriOf })
    expect(rootOf(json).maps).toEqual([{ uri: 'foil-polygons.json' }])
    const [back] = await diffractingOf(await load(json, {}, BAKED))
    expect(foilOf(back!).map).toBe(foilOf(material).map)
  })

  it('is a mesh as it was, and the size of a light', async () => {
    const scene = sceneOf(new DiffractionMaterial({ surface: grating({}) }))
    const light = new DirectionalLight()
    light.userData.angularRadius = 0.01
    scene.add(light)
    const { scene: back } = await load(await exportGlb(scene))
    const geometries = [scene, back].map((from) => (from.children[0] as Mesh).geometry)
    for (const name of ['position', 'normal', 'uv'])
      expect(geometries[1]!.getAttribute(name).array).toEqual(
        geometries[0]!.getAttribute(name).array,
      )
    const lights: unknown[] = []
    back.traverse(({ userData }) => {
      if ('angularRadius' in userData) lights.push(userData.angularRadius)
    })
    expect(lights).toEqual([0.01])
  })
})

describe('a file', () => {
  it.each(Object.entries(CASES))('of a %s is valid glTF', async (_name, make) => {
    const material = await make({ name: 'shown' })
    const glb = await exportGlb(sceneOf(material))
    const { json } = partsOf(glb)
    const { issues } = await validateBytes(new Uint8Array(glb))
    expect([issues.numErrors, issues.numWarnings]).toEqual([0, 0])
    // The validator does not know the extension, nor what it refers to.
    const known = [
      'UNSUPPORTED_EXTENSION /extensionsUsed',
      'UNUSED_OBJECT /meshes/0/primitives/0/attributes/TEXCOORD_0',
      ...viewsOf(json).map((view) => `UNUSED_OBJECT /bufferViews/${view}`),
    ]
    for (const { code, pointer } of issues.messages)
      expect(known).toContain(
        `${code} ${pointer.replace(/^\/extensionsUsed\/\d+$/, '/extensionsUsed')}`,
      )
    expect(schemaErrors(json)).toEqual([])
    expect(json.extensionsUsed).toContain(EXTENSION)
    expect(json.extensionsRequired ?? []).not.toContain(EXTENSION)
  })

  it('is a plain metal where the plugin is not', async () => {
    const warn = vi.spyOn(console, 'warn')
    const options = { metal: 'copper', roughness: 0.02, name: 'Copper' } as const
    const material = new DiffractionMaterial({ surface: await Foil.load(FEW), ...options })
    const glb = await exportGlb(sceneOf(material))
    const [plain] = materialsOf(await new GLTFLoader().parseAsync(glb, ''))
    expect(plain).toMatchObject({ type: 'MeshStandardMaterial', name: 'Copper', metalness: 1 })
    if (!(plain instanceof MeshStandardMaterial)) throw new Error()
    const { roughness, color } = plain
    // GGX of that α has slopes of variance α²/2.
    expect(roughness ** 4 / 2).toBeCloseTo(0.02 ** 2, 12)
    // As tables of materials for renderers have copper.
    ;[0.955, 0.638, 0.538].forEach((share, i) => {
      expect(Math.abs([color.r, color.g, color.b][i]! - share)).toBeLessThan(0.05)
    })
    expect(warn).not.toHaveBeenCalled()
  })

  it('is a matt base with an index of refraction, of a dielectric', async () => {
    const surface = field({ field: 'fingers', ior: 1.4 })
    const material = new DiffractionMaterial({ surface, color: 0x804020 })
    const glb = await exportGlb(sceneOf(material))
    const [plain] = materialsOf(await new GLTFLoader().parseAsync(glb, ''))
    expect(plain).toMatchObject({ type: 'MeshPhysicalMaterial', metalness: 0, ior: 1.4 })
    if (!(plain instanceof MeshPhysicalMaterial)) throw new Error()
    expect(plain.color.getHex()).toBe(0x804020)
  })
})

describe('exporting', () => {
  it('leaves other materials and the scene alone', async () => {
    const material = new DiffractionMaterial({ surface: grating({}) })
    const scene = sceneOf(material)
    await exportGlb(scene)
    expect(materialsOf({ scene: new Group().add(scene) })).toEqual([material])
    const json = await exportJson(sceneOf(new MeshStandardMaterial({ name: 'plain' })))
    expect(JSON.stringify(json)).not.toContain(EXTENSION)
  })

  it('fails with the error of a material that cannot be shown', async () => {
    const onError = (): void => undefined
    const surface = grating({ profile: 'nowhere' })
    const material = new DiffractionMaterial({ surface, onError })
    await expect(exportGlb(sceneOf(material))).rejects.toMatchObject({
      file: `${BAKED}profile-nowhere.json`,
    })
    const bright = new DiffractionMaterial({ surface: grating({}) })
    bright.color.setRGB(2, 0, 0)
    await expect(exportGlb(sceneOf(bright))).rejects.toMatchObject({
      name: 'DiffractionError',
      field: 'color',
    })
  })

  it('refuses a writer that has no step of that name', () => {
    expect(() => new GLTFDiffractionExporterPlugin({} as never)).toThrow(DiffractionError)
  })
})

function rootOf(json: Json): { maps: { arrays?: Record<string, { bufferView: number }> }[] } {
  return (json.extensions as Record<string, ReturnType<typeof rootOf>>)[EXTENSION]!
}

/** The buffer views of a file's maps. */
function viewsOf(json: Json): number[] {
  if (json.extensions === undefined) return []
  return rootOf(json).maps.flatMap(({ arrays = {} }) =>
    Object.values(arrays).map(({ bufferView }) => bufferView),
  )
}
