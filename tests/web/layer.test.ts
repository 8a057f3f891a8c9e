import {
  MeshBasicMaterial,
  MeshPhysicalMaterial,
  MeshStandardMaterial,
  REVISION,
  ShaderLib,
  Texture,
} from 'three'
import { MeshPhysicalNodeMaterial, NodeMaterialInstance } from 'three/webgpu'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { diffractionLayer, type DiffractionLayerOptions } from '../../web/layer/diffraction-layer'
import { intercept } from '../../web/layer/intercept'
import { layeredFragment } from '../../web/layer/layer-shader'
import { Grating } from '../../web/surfaces/grating'
import { HeightField } from '../../web/surfaces/height-field'
import { fakeLobes, fakeMetals, fakeProfile, filesOf, serveFiles } from './fake-maps'
import { refuses } from './refuses'

const surface = new Grating({ period: 1.6, height: 0.12 })
const fragment = ShaderLib.physical.fragmentShader

let mapsPath = ''
let folder = 0

beforeEach(() => {
  mapsPath = `layer${++folder}/`
  serveFiles(
    filesOf({
      [`${mapsPath}profile-sinusoidal`]: fakeProfile(),
      [`${mapsPath}lobes-1931-2-D65`]: fakeLobes(),
      [`${mapsPath}metals`]: fakeMetals(),
    }),
  )
})

afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the fragment stage', () => {
  it('has the surface in it, and all that was there', () => {
    const layered = layeredFragment(fragment, surface)
    expect(layered).toContain('surfaceRadianceFromLight')
    for (const line of fragment.split('\n')) expect(layered).toContain(line.trim())
  })

  it.each([
    '#include <clipping_planes_pars_fragment>',
    '#include <lights_fragment_begin>',
    '#include <aomap_fragment>',
    'vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;',
  ])('is refused without %s, or with two', (anchor) => {
    expect(fragment).toContain(anchor)
    const file = `three r${REVISION}, fragment stage of MeshPhysicalMaterial`
    for (const damaged of [fragment.replace(anchor, ''), fragment.replace(anchor, anchor + anchor)])
      refuses(() => layeredFragment(damaged, surface), file, anchor)
  })
})

describe('a layer', () => {
  const made = (
    options: Partial<DiffractionLayerOptions> = {},
    material = new MeshStandardMaterial(),
  ) => ({ material, layer: diffractionLayer(material, { surface, mapsPath, ...options }) })

  it('diffracts once its tables are there', async () => {
    const { material, layer } = made({ metal: 'gold', strength: 0.5 })
    expect(material.defines).not.toHaveProperty('DIFFRACTION')
    expect(layer.explain()[0]).toMatchObject({ feature: 'diffraction', included: false })
    await layer.ready
    expect(material.defines).toMatchObject({ STANDARD: '', DIFFRACTION: '', LAYER: '', USE_UV: '' })
    expect(layer.settings).toMatchObject({ metal: 'gold', strength: 0.5, surface, gamut: 'map' })
  })

  it('goes without a trace', async () => {
    const { material, layer } = made({}, new MeshPhysicalMaterial())
    const untouched = new MeshPhysicalMaterial()
    expect(material.customProgramCacheKey()).not.toBe(untouched.customProgramCacheKey())
    await layer.ready
    layer.remove()
    layer.remove()
    expect(material.defines).toEqual(untouched.defines)
    expect(material.customProgramCacheKey()).toBe(untouched.customProgramCacheKey())
    for (const name of ['onBeforeCompile', 'onBeforeRender', 'customProgramCacheKey'])
      expect(Object.hasOwn(material, name)).toBe(false)
    await made({}, material).layer.ready
  })

  it('leaves nothing where it goes before its tables come', async () => {
    const { material, layer } = made()
    layer.remove()
    await layer.ready
    layer.set({ diffraction: false, gamut: 'signed', roughness: 0.1 })
    await layer.ready
    expect(material.defines).toEqual({ STANDARD: '' })
  })

  it('stays when the material copies another, or its defines are replaced', async () => {
    const material = new MeshPhysicalMaterial()
    const { layer } = made({}, material)
    await layer.ready
    const defines = { ...material.defines }
    material.copy(new MeshPhysicalMaterial({ clearcoat: 1 }))
    expect(material.clearcoat).toBe(1)
    expect(material.defines).toEqual(defines)
    material.defines = { STANDARD: '', PHYSICAL: '', MINE: 1 }
    expect(material.defines).toEqual({ ...defines, MINE: 1 })
    layer.set({ diffraction: false })
    layer.remove()
    expect(Object.entries(material.defines)).toEqual([
      ['STANDARD', ''],
      ['PHYSICAL', ''],
      ['MINE', 1],
    ])
    material.defines = { STANDARD: '' }
    expect(material.defines).toEqual({ STANDARD: '' })
  })

  it('leaves defines that others have set', async () => {
    const material = new MeshStandardMaterial()
    Object.assign(material.defines!, { USE_UV: '1', MINE: 1 })
    const { layer } = made({}, material)
    await layer.ready
    material.defines!.LATER = 2
    layer.set({ diffraction: false })
    expect(material.defines).not.toHaveProperty('DIFFRACTION')
    layer.remove()
    expect(Object.entries(material.defines!)).toEqual([
      ['STANDARD', ''],
      ['USE_UV', '1'],
      ['MINE', 1],
      ['LATER', 2],
    ])
  })

  it('has a program of its own for each kind of surface, and for each hook of others', () => {
    const keys = [
      made().material,
      made({ surface: new HeightField({ field: 'x' }), onError: () => undefined }).material,
      ...[1, 2].map((number) => {
        const { material } = made()
        material.onBeforeCompile =
          number === 1
            ? (shader) => (shader.fragmentShader = 'one')
            : (shader) => (shader.fragmentShader = 'two')
        return material
      }),
    ].map((material) => material.customProgramCacheKey())
    expect(new Set(keys).size).toBe(4)
  })

  it('is not copied to a clone', () => {
    const clone = made().material.clone()
    expect(clone.customProgramCacheKey()).toBe(new MeshStandardMaterial().customProgramCacheKey())
    expect(clone.defines).toEqual({ STANDARD: '' })
  })

  it('refuses what it cannot do, and leaves the material as it was', () => {
    const name = 'diffractionLayer'
    const { material, layer } = made()
    const nodes = new MeshPhysicalNodeMaterial()
    for (const other of [new MeshBasicMaterial(), nodes, new NodeMaterialInstance(nodes)])
      refuses(() => made({}, other as never), name, 'material')
    refuses(() => made({}, material), name, 'material')
    const bare = new MeshStandardMaterial()
    const bad: [object, string][] = [
      [{ shininess: 3 }, 'option'],
      [{ strength: 1.1 }, 'strength'],
      [{ roughness: -1 }, 'roughness'],
      [{ metal: 'lead' }, 'metal'],
      [{ method: 'line-sum' }, 'method'],
      [{ maxError: 0 }, 'maxError'],
      [{ gamut: 'none' }, 'gamut'],
      [{ lightAngularRadius: 4 }, 'lightAngularRadius'],
      [{ envMap: new Texture() }, 'envMap'],
    ]
    for (const [options, field] of bad) {
      refuses(() => made(options, bare), name, field)
      refuses(
        () => {
          layer.set(options)
        },
        name,
        field,
      )
    }
    expect(bare.defines).toEqual({ STANDARD: '' })
    expect(Object.hasOwn(bare, 'onBeforeCompile')).toBe(false)
  })
})

it('is refused by a material whose hook takes out what it rests on', () => {
  const material = new MeshStandardMaterial()
  diffractionLayer(material, { surface, mapsPath })
  material.onBeforeCompile = (shader) => {
    shader.fragmentShader = shader.fragmentShader.replace('#include <aomap_fragment>', '')
  }
  const shader = { uniforms: {}, vertexShader: '', fragmentShader: fragment }
  refuses(
    () => {
      material.onBeforeCompile(shader as never, {} as never)
    },
    `three r${REVISION}, fragment stage of MeshPhysicalMaterial`,
    '#include <aomap_fragment>',
  )
})

describe('an intercepted method', () => {
  const target = (): { calls: string[]; run: (word: string) => string } => {
    const calls: string[] = []
    return { calls, run: (word) => `first ${word}` }
  }

  it('runs around whatever is set, through chains of any length', () => {
    const object = target()
    const restore = intercept<[string], string>(object, 'run', (next, word) => `(${next(word)})`)
    expect(object.run('a')).toBe('(first a)')
    for (const name of ['second', 'third']) {
      const found = object.run
      object.run = (word) => `${name} ${found(word)}`
    }
    expect(object.run('a')).toBe('(third second first a)')
    expect(object.run('b')).toBe('(third second first b)')
    restore()
    expect(object.run('a')).toBe('third second first a')
  })

  it('is what it was when ours is taken away, and gets over an exception', () => {
    const object = target()
    const first = object.run
    const restore = intercept<[string], string>(object, 'run', (next, word) => `(${next(word)})`)
    object.run = () => {
      throw new Error('no')
    }
    expect(() => object.run('a')).toThrow('no')
    object.run = (word) => `new ${word}`
    expect(object.run('a')).toBe('(new a)')
    object.run = first
    restore()
    expect(object.run).toBe(first)
  })
})
