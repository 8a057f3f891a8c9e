import {
  Mesh,
  MeshBasicMaterial,
  PlaneGeometry,
  Scene,
  Vector2,
  Vector3,
  PerspectiveCamera,
} from 'three'
import { afterAll, beforeAll, describe, expect, it, vi } from 'vitest'
import { efficiencyOf } from '../../demo/inspector/optics/efficiency'
import { gratingAt } from '../../demo/inspector/optics/grating-at'
import {
  gratingBrdf,
  orderShares,
  type GratingOptics,
} from '../../demo/inspector/optics/grating-brdf'
import {
  illuminantA,
  illuminantSpectrum,
  LightSpectrum,
} from '../../demo/inspector/optics/light-spectrum'
import {
  lineDirection,
  orderDirection,
  propagatingOrders,
  type Direction,
} from '../../demo/inspector/optics/orders'
import { Relief, reliefBrdf } from '../../demo/inspector/optics/relief'
import { frameOf, pickAt, pointAtUv } from '../../demo/inspector/picked-point'
import { loadTables } from '../../demo/inspector/point-optics'
import { seenOrders } from '../../demo/inspector/pictures/lobes'
import { normalCdf } from '../../demo/numbers/normal-cdf'
import type { Subject } from '../../demo/subjects/subject'
import { Foil, Grating } from '../../web'
import { loadMap, type LoadedMap } from '../../web/maps/load'
import { metalReflectance } from '../../web/spectrum/metal-reflectance'
import type { Energy } from '../../web'
import { serveBakedMaps } from './baked-maps'
import { python } from './python'

// Python starts for each.
vi.setConfig({ testTimeout: 60_000 })

let profile: LoadedMap
let metals: LoadedMap
let d65: LoadedMap

beforeAll(async () => {
  serveBakedMaps()
  profile = await loadMap('maps/baked/profile-blazed')
  metals = await loadMap('maps/baked/metals')
  d65 = await loadMap('maps/baked/lobes-1931-2-D65')
})

afterAll(() => {
  vi.unstubAllGlobals()
})

/** From angles off the normal and about it, °. */
function direction(tilt: number, turn: number): Direction {
  const [θ, φ] = [(tilt * Math.PI) / 180, (turn * Math.PI) / 180]
  return [Math.sin(θ) * Math.cos(φ), Math.sin(θ) * Math.sin(φ), Math.cos(θ)]
}

const DIRECTIONS = [direction(0, 0), direction(35, 20), direction(70, 200), direction(88, 90)]
const WAVELENGTHS = [0.38, 0.55, 0.78]

function blazed(energy: Energy): GratingOptics {
  return {
    ...{ period: 1.4, height: 0.14, maxOrder: 16, energy },
    ...{ coherence: 16.25, roughness: 0.012 },
    efficiency: efficiencyOf(profile),
    reflectance: metalReflectance(metals, 'gold'),
  }
}

/** The directions of all pairs of light and viewer in which the reference is asked. */
const PAIRS = DIRECTIONS.flatMap((wi) =>
  DIRECTIONS.map((wo) => ({ wi, wo })).flatMap(({ wi, wo }) =>
    [-0.02, 0, 0.01].map((shift) => ({
      wi,
      // On an order's lobe, and beside it.
      wo: orderDirection([wi[0] + shift, wi[1] + shift / 2, wi[2]], 1, 0.55, 1.4) ?? wo,
    })),
  ),
).map(({ wi, wo }) => ({ wi, wo: unit(wo) }))

function unit([x, y, z]: Direction): Direction {
  const length = Math.hypot(x, y, z)
  return [x / length, y / length, z / length]
}

describe('orders', () => {
  it('propagate as in the reference', async () => {
    const cases = DIRECTIONS.flatMap((ω) => WAVELENGTHS.map((λ) => [ω, λ] as const))
    const expected = await python(
      `
import numpy as np
from precompute.reference import order_direction, propagating_orders
out = []
for direction, wavelength in input:
    d = np.array(direction)
    orders = propagating_orders(d, wavelength, 1.66).tolist()
    out.append([[m, *order_direction(d, m, wavelength, 1.66).tolist()] for m in orders])
print(json.dumps(out))`,
      cases,
    )
    const found = cases.map(([ω, λ]) =>
      propagatingOrders(ω, λ, 1.66).map((m) => [m, ...orderDirection(ω, m, λ, 1.66)!]),
    )
    expect(found.map((orders) => orders.map(([m]) => m))).toEqual(
      (expected as number[][][]).map((orders) => orders.map(([m]) => m)),
    )
    found.flat(2).forEach((value, i) => {
      expect(value).toBeCloseTo((expected as number[][][]).flat(2)[i]!, 9)
    })
  })

  it('come from directions that the grating equation sends to the viewer', () => {
    const wo = direction(35, 20)
    for (const m of propagatingOrders(wo, 0.55, 1.66)) {
      const wi = orderDirection(wo, m, 0.55, 1.66)!
      expect(wi[0] + wo[0]).toBeCloseTo((m * 0.55) / 1.66, 12)
      expect(wi[1] + wo[1]).toBeCloseTo(0, 12)
      expect(Math.hypot(...wi)).toBeCloseTo(1, 12)
    }
    // A line of a relief along x is such a grating.
    const ofLine = lineDirection(wo, [2 / 1.66, 0], 0.55)!
    orderDirection(wo, 2, 0.55, 1.66)!.forEach((value, i) => {
      expect(ofLine[i]).toBeCloseTo(value, 12)
    })
  })

  it('are named with the visible wavelength that they show at u', () => {
    expect(seenOrders(0.66, 1.66)).toEqual([{ order: 2, wavelength: (0.66 * 1.66) / 2 }])
    expect(seenOrders(-0.66, 1.66)[0]!.order).toBe(-2)
    expect(seenOrders(0.1, 1.66)).toEqual([])
  })
})

describe('the radiance of a grating', () => {
  it.each(['conserving', 'reciprocal', 'kirchhoff'] as const)(
    'is the reference’s, energy %s',
    async (energy) => {
      const expected = (await python(
        `
import numpy as np
from precompute.gratings import Grating
from precompute.reference import spectral_brdf
pairs, wavelengths, energy = input
g = Grating(period=1.4, height=0.14, profile="blazed", metal="gold", coherence=16.25, roughness=0.012, energy=energy)
wi, wo = (np.array([p[k] for p in pairs]) for k in ("wi", "wo"))
print(json.dumps([spectral_brdf(g, wi, wo, np.full(len(wi), w), 0.01).tolist() for w in wavelengths]))`,
        [PAIRS, [0.45, 0.55, 0.65], energy],
      )) as number[][]
      const optics = blazed(energy)
      const found = [0.45, 0.55, 0.65].map((λ) =>
        PAIRS.map(({ wi, wo }) => gratingBrdf(optics, wi, wo, λ, 0.01)),
      )
      const most = Math.max(...expected.flat())
      expect(most).toBeGreaterThan(10)
      found.flat().forEach((value, i) => {
        // Table and metal are stored in half floats.
        const exact = expected.flat()[i]!
        expect(Math.abs(value - exact)).toBeLessThan(3e-3 * exact + 1e-6 * most)
      })
    },
  )

  it('is shared out among the orders without loss', () => {
    const mirror = { ...blazed('conserving'), reflectance: () => 1 }
    const wo = direction(35, 20)
    const sum = orderShares(mirror, wo, 0.55).reduce((total, share) => total + share)
    expect(sum).toBeCloseTo(1, 6)
  })
})

describe('the radiance of a height field', () => {
  it('is the reference’s', async () => {
    const pairs = DIRECTIONS.slice(0, 3).flatMap((wi) =>
      [0, 0.03, 0.1, 0.2, 0.35].flatMap((distance) =>
        [0, 1, 2.5, 4].flatMap((turn) => {
          const f = [distance * Math.cos(turn), distance * Math.sin(turn)] as const
          const wo = lineDirection(wi, f, 1)
          return wo === null ? [] : [{ wi, wo }]
        }),
      ),
    )
    const expected = (await python(
      `
import numpy as np
from pathlib import Path
from precompute.height_fields.prepare import prepared
from precompute.height_fields.recipe import HeightFieldRecipe
from precompute.height_fields.optics import HeightFieldOptics
from precompute.height_fields.reference import spectral_brdf
field = prepared(HeightFieldRecipe.model_validate_json(Path("maps/recipes/height-field-bumps.json").read_text()), Path("maps/recipes"))
wi, wo = (np.array([p[k] for p in input]) for k in ("wi", "wo"))
optics = HeightFieldOptics(metal="gold", roughness=0.012)
print(json.dumps([spectral_brdf(field, optics, wi, wo, np.full(len(wi), w), 0.01).tolist() for w in (0.45, 0.6)]))`,
      pairs,
    )) as number[][]
    const relief = new Relief(await loadMap('maps/baked/height-field-bumps-jacobi-anger'))
    const gold = metalReflectance(metals, 'gold')
    const found = [0.45, 0.6].map((λ) =>
      pairs.map(({ wi, wo }) =>
        reliefBrdf(
          { relief, reflectance: gold, isRelative: false, coherence: 16.25, roughness: 0.012 },
          ...([wi, wo, λ, 0.01] as const),
        ),
      ),
    )
    const most = Math.max(...expected.flat())
    found.flat().forEach((value, i) => {
      expect(Math.abs(value - expected.flat()[i]!)).toBeLessThan(
        5e-3 * expected.flat()[i]! + 1e-3 * most,
      )
    })
    expect(most).toBeGreaterThan(1)
  })
})

describe('spectra', () => {
  it.each([
    ['1931-2', 'D65'],
    ['1931-2', 'A'],
    ['2015-2', 'D65'],
  ] as const)('have the illuminants’ relative power: observer %s, %s', async (observer, name) => {
    const expected = (await python(
      'from precompute.spectra import illuminant\nprint(json.dumps(illuminant(input).tolist()))',
      name,
    )) as number[]
    const material = { mapsPath: 'maps/baked/', observer, illuminant: name }
    const surface = new Grating({ period: 1.6, height: 0.12 })
    const { illuminant } = await loadTables({ surface, material } as unknown as Subject)
    expect(illuminant.length).toBe(401)
    // Averaged over 5 nm, and near the ends with few digits.
    illuminant.forEach((value, i) => {
      expect(Math.abs(value - expected[i]!)).toBeLessThan(i > 15 && i < 350 ? 0.02 : 0.05)
    })
  })

  it('of an observer that sees less are relative to one that is known', async () => {
    // As far as the observer of 2015 sees: light A over what its D65 is.
    const known = new LightSpectrum(await loadMap('maps/baked/lobes-2015-2-D65'))
    const d65 = new LightSpectrum(await loadMap('maps/baked/lobes-1931-2-D65'))
    expect(known.white(3)).toEqual([0, 0, 0])
    const power = illuminantSpectrum(known, known, d65.wavelengths.map(illuminantA))
    // Nothing of it is NaN, and a quotient of one with itself is 1.
    power.forEach((value, i) => {
      expect(value).toBeCloseTo(
        illuminantA(known.wavelengths[i]!) / illuminantA(known.wavelengths[400]!),
        6,
      )
    })
  })

  it('give a white mirror the colour white', () => {
    const spectrum = new LightSpectrum(d65)
    const rgb = spectrum.colour(new Float64Array(401).fill(1))
    for (const channel of rgb) expect(channel).toBeCloseTo(1, 4)
    const bases = [0, 1, 2].map((tint) => spectrum.basis(200, tint))
    expect(bases.reduce((sum, share) => sum + share)).toBeCloseTo(1, 6)
    expect(Math.max(...bases)).toBe(bases[1])
  })
})

describe('a picked point', () => {
  const geometry = new PlaneGeometry(2, 1, 4, 3)
  const material = new MeshBasicMaterial()
  const mesh = new Mesh(geometry, material)
  mesh.rotation.set(0.3, -0.4, 0.2)
  mesh.position.set(0.1, 0, -0.2)
  const scene = new Scene().add(mesh)
  const camera = new PerspectiveCamera(30, 1, 0.1, 10)
  camera.position.z = 4
  scene.updateMatrixWorld()
  camera.updateMatrixWorld()

  it('is seen where it was picked, in the mesh’s own frame', () => {
    const place = new Vector2(0.12, -0.07)
    const point = pickAt(place, camera, scene, material)!
    const { position, tangent, bitangent, normal } = frameOf(point, camera.position)
    const { x, y } = position.clone().project(camera)
    expect(x).toBeCloseTo(place.x, 9)
    expect(y).toBeCloseTo(place.y, 9)
    for (const [axis, own] of [
      [tangent, new Vector3(1, 0, 0)],
      [bitangent, new Vector3(0, 1, 0)],
      [normal, new Vector3(0, 0, 1)],
    ] as const)
      expect(axis.dot(own.transformDirection(mesh.matrixWorld))).toBeCloseTo(1, 9)
  })

  it('can be found by its texture coordinates', () => {
    const point = pickAt(new Vector2(0.12, -0.07), camera, scene, material)!
    const other = pointAtUv(point, point.uv)!
    const [here, there] = [point, other].map((p) => frameOf(p, camera.position).position)
    expect(here!.distanceTo(there!)).toBeLessThan(1e-9)
    expect(pointAtUv(point, new Vector2(1.2, 0.5))).toBeNull()
    expect(pickAt(new Vector2(0.95, 0.95), camera, scene, material)).toBeNull()
  })
})

describe('the grating at a place', () => {
  it('is the texel’s, of the tile that the place lies in', async () => {
    const map = await loadMap('maps/baked/foil-polygons')
    const foil = new Foil(map, { repeat: new Vector2(3, 2) })
    const texels = (await python(`
from pathlib import Path
from precompute.maps import Map
values = Map.read(Path("maps/baked/foil-polygons")).tables["grating"].values
print(json.dumps([values.shape[0], values[10, 200].tolist()]))`)) as [number, number[]]
    const [size, [cos2, sin2, frequency, strength]] = texels as [
      number,
      [number, number, number, number],
    ]
    const [u, v] = [(1 + 200.5 / size) / 3, (1 + 1 - 10.5 / size) / 2]
    const at = gratingAt(foil, u, v)
    expect(at.texel).toEqual({ column: 200, row: 10 })
    expect(at.orientation).toBeCloseTo(Math.atan2(sin2, cos2) / 2, 6)
    expect(at.period).toBeCloseTo(1 / frequency, 5)
    expect(at.strength).toBeCloseTo(strength, 6)
  })

  it('lies along the radius of circular tracks', () => {
    const disc = new Grating({ period: 1.6, height: 0.12, tracks: 'circular' })
    expect(gratingAt(disc, 0.5, 0.9).orientation).toBeCloseTo(Math.PI / 2, 12)
    expect(gratingAt(disc, 0.1, 0.5).orientation).toBeCloseTo(Math.PI, 12)
  })
})

it('has the normal distribution to the last digits', async () => {
  const x = [-9, -6.5, -3, -1, -0.1, 0, 0.3, 2, 5, 8]
  const expected = (await python(
    'from scipy.special import ndtr\nprint(json.dumps(ndtr(input).tolist()))',
    x,
  )) as number[]
  x.forEach((value, i) => {
    expect(Math.abs(normalCdf(value) - expected[i]!)).toBeLessThan(2e-15)
  })
})
