import { Vector2 } from 'three'
import { DiffractionMaterial } from '../../web/materials/DiffractionMaterial'
import { loadMap } from '../../web/maps/load'
import { Foil } from '../../web/surfaces/foil'
import { Grating } from '../../web/surfaces/grating'
import { HeightField } from '../../web/surfaces/height-field'
import {
  fakeBaked,
  fakeFoil,
  fakeLobes,
  fakeMetals,
  fakeProfile,
  fakeTerms,
  filesOf,
  serveFiles,
} from './fake-maps'
import { exportGlb, sceneOf, serveData } from './gltf-files'

/** Where the fake tables are served. */
export const FAKES = 'gltf-fakes/'

export function serveFakes(): void {
  const maps = {
    'profile-sinusoidal': fakeProfile(),
    'profile-mine': fakeProfile(),
    'lobes-1931-2-D65': fakeLobes(),
    'lobes-mine': fakeLobes(),
    metals: fakeMetals(),
    foil: fakeFoil(),
    'height-field-x-jacobi-anger': fakeTerms(),
    'height-field-y-baked': fakeBaked(),
  }
  const entries = Object.entries(maps).map(([name, map]) => [FAKES + name, map] as const)
  serveFiles(filesOf(Object.fromEntries(entries)))
  serveData()
}

/** Small files with every kind of surface and of map, and every field of the extension somewhere. */
export async function fakeGlbs(): Promise<Record<FakeName, ArrayBuffer>> {
  const illuminant = `${FAKES}lobes-mine`
  const common = {
    mapsPath: FAKES,
    ...{ lightAngularRadius: 0.01, coat: 0.5, coatIor: 1.4, coatRoughness: 0.2, color: 0x808080 },
    ...{ planarEnvironment: false, diffraction: false, maxError: 0.1 },
    gamut: 'signed',
  } as const
  const materials: Record<FakeName, DiffractionMaterial> = {
    grating: new DiffractionMaterial({
      ...common,
      surface: new Grating({
        ...{ period: 1.5, height: 0.1, orientation: 0.5, tracks: 'circular', strength: 0.5 },
      }),
      ...{ method: 'wavelength-loop', efficiencies: 'taylor' },
      ...{ wavelengthStep: 0.01, environmentNodes: 8 },
    }),
    tables: new DiffractionMaterial({
      mapsPath: FAKES,
      illuminant,
      surface: new Grating({ period: 1.5, height: 0.1, profile: `${FAKES}profile-mine` }),
    }),
    foil: new DiffractionMaterial({
      mapsPath: FAKES,
      surface: new Foil(await loadMap(`${FAKES}foil`), {
        ...{ height: 0.2, filtered: false },
        repeat: new Vector2(2, 3),
      }),
    }),
    heightField: new DiffractionMaterial({
      mapsPath: FAKES,
      surface: new HeightField({ field: 'x', orientation: 1, strength: 0.5, ior: 1.5 }),
    }),
    baked: new DiffractionMaterial({
      mapsPath: FAKES,
      surface: new HeightField({ field: 'y' }),
      ...{ method: 'baked', roughness: 0.02, metal: 'gold' },
    }),
  }
  const glbs = Object.entries(materials).map(
    async ([name, material]) => [name, await exportGlb(sceneOf(material))] as const,
  )
  return Object.fromEntries(await Promise.all(glbs)) as Record<FakeName, ArrayBuffer>
}

export type FakeName = 'grating' | 'tables' | 'foil' | 'heightField' | 'baked'
