import {
  BufferGeometry,
  EquirectangularReflectionMapping,
  DataTexture,
  Group,
  LinearFilter,
  LinearMipmapLinearFilter,
  Mesh,
  PerspectiveCamera,
  RepeatWrapping,
  Scene,
  Texture,
  UVMapping,
  type WebGLRenderer,
} from 'three'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { DiffractionError } from '../../web/errors'
import { loadMap } from '../../web/maps/load'
import { DiffractionMaterial } from '../../web/materials/DiffractionMaterial'
import type { DiffractionMaterialOptions } from '../../web/materials/options'
import { Foil } from '../../web/surfaces/foil'
import { Grating } from '../../web/surfaces/grating'
import { HeightField } from '../../web/surfaces/height-field'
import {
  fakeFoil,
  fakeLobes,
  fakeMetals,
  fakeProfile,
  filesOf,
  serveFiles,
  type FakeMap,
} from './fake-maps'

let folder = 0
let mapsPath = ''

/** Every test has a folder of its own: loaded maps are shared by address. */
beforeEach(() => {
  mapsPath = `maps${++folder}/`
  serve({})
})

afterEach(() => {
  vi.unstubAllGlobals()
})

function serve(more: Record<string, FakeMap>): void {
  const maps: Record<string, FakeMap> = {
    'profile-sinusoidal': fakeProfile(),
    'lobes-1931-2-D65': fakeLobes(),
    metals: fakeMetals(),
    ...more,
  }
  const atFolder = Object.entries(maps).map(([name, map]) => [mapsPath + name, map])
  serveFiles(filesOf(Object.fromEntries(atFolder) as Record<string, FakeMap>))
}

function makeMaterial(options: Partial<DiffractionMaterialOptions> = {}): DiffractionMaterial {
  const surface = new Grating({ period: 1.6, height: 0.1 })
  return new DiffractionMaterial({ surface, mapsPath, onError: () => undefined, ...options })
}

const included = (material: DiffractionMaterial, feature: string): boolean | undefined =>
  material.explain().find((entry) => entry.feature === feature)?.included

/** What three calls before it draws a mesh. */
function beforeDraw(material: DiffractionMaterial): void {
  const renderer = { info: { render: { frame: 0 } } } as object as WebGLRenderer
  const geometry = new BufferGeometry()
  const mesh = new Mesh(geometry, material)
  material.onBeforeRender(
    renderer,
    new Scene(),
    new PerspectiveCamera(),
    geometry,
    mesh,
    new Group(),
  )
}

describe('loading', () => {
  it('makes nothing for an environment before there is one', async () => {
    const material = makeMaterial()
    await material.ready
    expect(material.uniforms).toHaveProperty('uLightNodes')
    expect(material.uniforms).not.toHaveProperty('uEnvironmentNodes')
    expect(included(material, 'nodes along the environment')).toBe(false)
    expect(included(material, 'lights')).toBe(false)
  })

  it('leaves diffraction out until the tables are there', async () => {
    const material = makeMaterial()
    expect(material.defines).not.toHaveProperty('DIFFRACTION')
    expect(included(material, 'diffraction')).toBe(false)
    await material.ready
    expect(material.defines.DIFFRACTION).toBe('')
    expect(included(material, 'diffraction')).toBe(true)
  })

  it('rejects with the error that names the file, and tells onError', async () => {
    const onError = vi.fn()
    const material = makeMaterial({ illuminant: 'candle', onError })
    await expect(material.ready).rejects.toBeInstanceOf(DiffractionError)
    expect(onError).toHaveBeenCalledExactlyOnceWith(
      expect.objectContaining({ file: `${mapsPath}lobes-1931-2-candle.json` }),
    )
    expect(material.explain()[0]).toMatchObject({ feature: 'diffraction', included: false })
    expect(material.explain()[0]!.why).toContain('candle')
  })

  it('keeps the last good state when a later table fails, and recovers', async () => {
    const material = makeMaterial()
    await material.ready
    material.illuminant = 'candle'
    await expect(material.ready).rejects.toBeInstanceOf(DiffractionError)
    expect(material.illuminant).toBe('D65')
    expect(material.defines.DIFFRACTION).toBe('')

    serve({ 'lobes-1931-2-candle': fakeLobes() })
    material.illuminant = 'candle'
    await material.ready
    expect(material.illuminant).toBe('candle')
  })

  it('shows the last of several requests', async () => {
    serve({ 'lobes-1931-2-A': fakeLobes(), 'lobes-2015-2-A': fakeLobes() })
    const material = makeMaterial()
    material.illuminant = 'A'
    material.observer = '2015-2'
    await material.ready
    expect([material.illuminant, material.observer]).toEqual(['A', '2015-2'])
  })

  it('takes maps that are at hand in the place of what their addresses would fetch', async () => {
    serve({ 'lobes-mine': fakeLobes(), 'profile-mine': fakeProfile(7) })
    const maps = {
      'my/lobes': await loadMap(`${mapsPath}lobes-mine`),
      'my/profile': await loadMap(`${mapsPath}profile-mine`),
    }
    serve({})
    const surface = new Grating({ period: 1.6, height: 0.1, profile: 'my/profile' })
    const material = makeMaterial({ surface, illuminant: 'my/lobes', maps })
    const copy = makeMaterial().copy(material)
    for (const shown of [material, material.clone(), copy]) {
      await shown.ready
      expect(shown.illuminant).toBe('my/lobes')
      expect(shown.defines.PHASE_MAX).toBe('7.0')
    }
  })

  it('hears of a surface whose profile changed', async () => {
    const surface = new Grating({ period: 1.6, height: 0.1 })
    const material = makeMaterial({ surface })
    await material.ready
    surface.profile = 'unknown'
    await expect(material.ready).rejects.toMatchObject({
      file: `${mapsPath}profile-unknown.json`,
    })
  })
})

describe('setters', () => {
  it.each([
    ['coherence', [0, -1, NaN, Infinity]],
    ['roughness', [-1, NaN, Infinity]],
    ['wavelengthStep', [0, NaN, 1]],
    ['lightAngularRadius', [0, -1, NaN, Infinity]],
    ['coat', [-0.1, 1.1, NaN]],
    ['coatIor', [0.9, NaN]],
    ['coatRoughness', [-1, 2, NaN]],
    ['environmentNodes', [0, NaN]],
    ['metal', ['tin', undefined]],
    ['observer', ['1964-10']],
    ['energy', ['free']],
    ['method', ['magic']],
    ['efficiencies', ['guess']],
    ['gamut', ['wide']],
    ['illuminant', ['', undefined]],
  ])('%s refuses what means nothing', (field, values) => {
    const material = makeMaterial()
    for (const value of values) {
      const before = material[field as 'coherence']
      expect(() => {
        material[field as 'coherence'] = value as number
      }).toThrow(expect.objectContaining({ file: 'DiffractionMaterial', field }) as Error)
      expect(material[field as 'coherence']).toBe(before)
    }
  })

  it('refuse at construction too', () => {
    expect(() => makeMaterial({ coherence: 0 })).toThrow(DiffractionError)
  })

  it('give way to the defaults of another surface, but for those that were given', () => {
    const [grating, field] = [
      new Grating({ period: 1.6, height: 0.1 }),
      new HeightField({ field: 'x' }),
    ]
    const tiled = new HeightField({ field: 'x', tiles: 2 })
    const material = makeMaterial({ surface: grating })
    const shown = (): string[] => [material.method, material.energy]
    material.surface = tiled
    expect(shown()).toEqual(['jacobi-anger', 'kirchhoff'])
    material.surface = field
    expect(shown()).toEqual(['line-sum', 'kirchhoff'])
    material.surface = grating
    expect(shown()).toEqual(['closed-form', 'conserving'])
    Object.assign(material, { method: 'wavelength-loop', energy: 'kirchhoff' })
    material.surface = new Grating({ period: 1, height: 0.1 })
    expect(shown()).toEqual(['wavelength-loop', 'kirchhoff'])
    material.surface = field
    material.surface = grating
    expect(shown()).toEqual(['closed-form', 'kirchhoff'])
  })

  it('change uniforms without a new program', async () => {
    const surface = new Grating({ period: 1.6, height: 0.1 })
    const material = makeMaterial({ surface, coat: 0.5, roughness: 0.02 })
    await material.ready
    const { version } = material
    material.coherence = 10
    material.roughness = 0.01
    material.metal = 'gold'
    material.coat = 0.25
    material.coatRoughness = 0.5
    material.lightAngularRadius = 0.01
    surface.height = 0.11
    surface.period = 1.61
    surface.orientation = 1
    await material.ready
    expect(material.version).toBe(version)
  })

  it('make a new program only where the shader changes', async () => {
    const material = makeMaterial()
    await material.ready
    for (const change of [
      () => (material.coat = 0.5),
      () => (material.coat = 0),
      () => (material.gamut = 'signed'),
      () => (material.diffraction = false),
      () => (material.energy = 'kirchhoff'),
      () => (material.map = new Texture()),
    ]) {
      const { version } = material
      change()
      expect(material.version).toBeGreaterThan(version)
      const again = material.version
      const { gamut, diffraction, coat } = material
      Object.assign(material, { gamut, diffraction, coat })
      expect(material.version).toBe(again)
    }
  })

  it('frees the tables of settings that are gone with the next frame', async () => {
    const material = makeMaterial()
    await material.ready
    beforeDraw(material)
    const freed = disposals(material, ['uLightNodes', 'uLobeTable', 'uEfficiencyTable'])
    material.metal = 'copper'
    expect(freed).toEqual([])
    beforeDraw(material)
    expect(freed.sort()).toEqual(['uLightNodes', 'uLobeTable'])
  })

  it('frees what a foil brings, bumps among it, when the last who drew it is disposed of', async () => {
    const normal = { pixels: new Uint8Array(4), size: [1, 1] as [number, number] }
    serve({ foil: fakeFoil(undefined, undefined, normal) })
    const surface = await Foil.load(`${mapsPath}foil`)
    const [one, other, notDrawn] = [1, 2, 3].map(() => makeMaterial({ surface })) as [
      DiffractionMaterial,
      DiffractionMaterial,
      DiffractionMaterial,
    ]
    await Promise.all([one.ready, other.ready, notDrawn.ready])
    expect(included(one, 'bumps')).toBe(true)
    beforeDraw(one)
    beforeDraw(other)
    const names = ['uFoilMap', 'uFoilNormal', 'uFoilShares']
    const freed = disposals(one, names)
    notDrawn.dispose()
    one.dispose()
    one.dispose()
    expect(freed).toEqual([])
    other.dispose()
    expect(freed.sort()).toEqual(names)
  })

  /** The names of uniforms whose textures are disposed of from now on. */
  function disposals(material: DiffractionMaterial, names: readonly string[]): string[] {
    const freed: string[] = []
    for (const name of names)
      (material.uniforms[name]!.value as Texture).addEventListener('dispose', () => {
        freed.push(name)
      })
    return freed
  }
})

describe('the environment', () => {
  function equirect(): DataTexture {
    const texture = new DataTexture(new Float32Array(8 * 4 * 4), 8, 4)
    texture.mapping = EquirectangularReflectionMapping
    texture.minFilter = LinearFilter
    texture.needsUpdate = true
    return texture
  }

  it('is sampled from a copy with mip levels where it has none, and stays as it was', () => {
    const material = makeMaterial()
    const texture = equirect()
    material.envMap = texture
    const copy = material.envMap
    expect(copy).not.toBe(texture)
    expect(copy.source).toBe(texture.source)
    expect(copy).toMatchObject({
      mapping: UVMapping,
      minFilter: LinearMipmapLinearFilter,
      wrapS: RepeatWrapping,
      generateMipmaps: true,
    })
    expect(texture).toMatchObject({
      mapping: EquirectangularReflectionMapping,
      minFilter: LinearFilter,
      generateMipmaps: false,
    })
    material.envMap = copy
    expect(material.envMap).toBe(copy)
  })

  it('refuses what PMREMGenerator made, and textures that are no environment', () => {
    const material = makeMaterial()
    const filtered = equirect()
    filtered.isPMREMTexture = true
    for (const texture of [filtered, new Texture()])
      expect(() => {
        material.envMap = texture
      }).toThrow(expect.objectContaining({ field: 'envMap' }) as Error)
    expect(material.envMap).toBeNull()
  })
})

it('clones with its settings, and shares its surface', async () => {
  const material = makeMaterial({ metal: 'gold', coat: 0.5, opacity: 0.5, color: 0xff0000 })
  await material.ready
  const clone = material.clone()
  await clone.ready
  expect(clone.surface).toBe(material.surface)
  expect(clone).toMatchObject({ metal: 'gold', coat: 0.5, opacity: 0.5 })
  expect(clone.color.getHex()).toBe(0xff0000)
  expect(clone.color).not.toBe(material.color)
  expect(clone.uniforms.uEfficiencyTable!.value).toBe(material.uniforms.uEfficiencyTable!.value)
})
