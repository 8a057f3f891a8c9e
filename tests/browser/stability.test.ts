import { readFileSync } from 'node:fs'
import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { StabilityProgram, StabilityResult, StabilitySet } from './harness/stability'
import { openHarness } from './open-harness.mjs'
import { normalized, type HarnessHandle, type Vector } from './read-scene'

/** Where a set may go; each is drawn from the seed alone. */
interface Program extends StabilityProgram {
  /** Pictures drawn. */
  sets: number
  /** Longest period, µm, of a grating. */
  longest?: number
  /** Least and largest roughness, rad; left out where it is baked in, or would need another program. */
  roughness?: readonly [number, number]
  /** Least and largest standard deviation of the light, rad; a point where left out. */
  radii?: readonly [number, number]
  /** Least coherence, µm: a quarter of a grating's period where left out. */
  leastCoherence?: number
}

interface Case {
  program: string
  set: StabilitySet
}

/** 30°, rad. */
const WIDEST = Math.PI / 6

/** Of a grating's relief, µm: what the baked profiles' tables hold. */
const HIGHEST = 0.6

const grating = { kind: 'grating', period: 100, height: HIGHEST } as const
/** Blurred, so that wide lobes of all orders are compiled in. */
const blurred = { longest: 100, roughness: [1e-6, WIDEST], radii: [1e-5, WIDEST] } as const
const blurredMaterial = { roughness: WIDEST } as const
const series = { kind: 'height-field', field: 'bumps' } as const

const PROGRAMS: Record<string, Program> = {
  conserving: { ...blurred, surface: grating, material: blurredMaterial, sets: 2000 },
  reciprocal: {
    ...blurred,
    surface: { ...grating, profile: 'blazed' },
    material: { ...blurredMaterial, energy: 'reciprocal' },
    sets: 2000,
  },
  kirchhoff: {
    ...blurred,
    surface: { ...grating, profile: 'rectangular' },
    material: { ...blurredMaterial, energy: 'kirchhoff' },
    sets: 2000,
  },
  'tinted, under a lacquer': {
    ...blurred,
    surface: { ...grating, profile: 'triangular' },
    material: { ...blurredMaterial, metal: 'gold', coat: 1, coatRoughness: 0 },
    color: [1, 0, 0.3],
    sets: 2000,
  },
  sharp: {
    // Order 0 alone is ever wide.
    surface: { ...grating, period: 1.6 },
    longest: 1.6,
    leastCoherence: 16.25,
    sets: 2000,
  },
  'wavelength loop': {
    ...blurred,
    surface: grating,
    material: { ...blurredMaterial, method: 'wavelength-loop', wavelengthStep: 0.05 },
    sets: 600,
  },
  'height field, line sum': {
    surface: series,
    material: { roughness: WIDEST },
    roughness: [1e-6, WIDEST],
    radii: [1e-5, WIDEST],
    leastCoherence: 10,
    sets: 150,
  },
  'height field, relative, dielectric, tinted': {
    surface: { ...series, ior: 1.5 },
    material: { roughness: WIDEST, energy: 'relative' },
    color: [0.2, 0, 1],
    roughness: [1e-6, WIDEST],
    radii: [1e-5, WIDEST],
    leastCoherence: 10,
    sets: 100,
  },
  'height field, repeats': {
    surface: { ...series, tiles: [3, 8] },
    material: { method: 'jacobi-anger', wavelengthStep: 0.05, roughness: WIDEST },
    roughness: [1e-6, WIDEST],
    radii: [1e-5, WIDEST],
    sets: 100,
  },
  'height field, baked': {
    surface: series,
    material: { method: 'baked', roughness: 0.0175 },
    sets: 2000,
  },
  'a foil': {
    roughness: blurred.roughness,
    radii: blurred.radii,
    leastCoherence: 1,
    surface: { kind: 'foil', map: '/maps/baked/foil-polygons' },
    material: blurredMaterial,
    sets: 300,
  },
  'a foil of many gratings, from afar': {
    roughness: blurred.roughness,
    radii: blurred.radii,
    leastCoherence: 1,
    surface: { kind: 'foil', map: '/maps/baked/foil-glitter', repeat: [20, 20] },
    material: blurredMaterial,
    sets: 100,
  },
  'a point light': {
    ...blurred,
    surface: { ...grating, profile: 'sampled' },
    material: blurredMaterial,
    light: 'point',
    sets: 1000,
  },
  'a spot light': {
    surface: { ...grating, period: 1.6 },
    longest: 1.6,
    leastCoherence: 16.25,
    light: 'spot',
    sets: 1000,
  },
  'a harsh environment': {
    ...blurred,
    surface: grating,
    material: blurredMaterial,
    environment: 'float',
    sets: 300,
  },
  'a harsh environment in halves, sharp, reciprocal': {
    surface: { ...grating, period: 1.6 },
    material: { energy: 'reciprocal' },
    longest: 1.6,
    leastCoherence: 16.25,
    environment: 'half',
    sets: 300,
  },
  'a harsh environment on a foil under a lacquer': {
    surface: { kind: 'foil', map: '/maps/baked/foil-polygons' },
    material: { ...blurredMaterial, coat: 1, coatRoughness: 0.2 },
    roughness: blurred.roughness,
    environment: 'half',
    sets: 100,
  },
  'a harsh environment on a foil of many gratings': {
    surface: { kind: 'foil', map: '/maps/baked/foil-glitter', repeat: [4, 4] },
    material: blurredMaterial,
    roughness: blurred.roughness,
    environment: 'float',
    sets: 50,
  },
  'a harsh environment on a height field': {
    surface: series,
    material: { roughness: WIDEST },
    roughness: [1e-6, WIDEST],
    leastCoherence: 10,
    environment: 'float',
    sets: 100,
  },
  'height field, sharp series': {
    surface: series,
    material: { method: 'jacobi-anger', wavelengthStep: 0.05 },
    leastCoherence: 10,
    sets: 400,
  },
}

/** Numbers in [0, 1), the same every time: a linear congruence modulo 2³² (Knuth's multiplier), its high bits. */
class Random {
  #state: number

  constructor(seed: number) {
    this.#state = seed
  }

  next(): number {
    this.#state = (Math.imul(this.#state, 1664525) + 1013904223) >>> 0
    return (this.#state >>> 8) / 2 ** 24
  }

  uniform(low: number, high: number): number {
    return low + (high - low) * this.next()
  }

  /** Equally likely in any power of ten. */
  decades(low: number, high: number): number {
    return low * (high / low) ** this.next()
  }

  /** One of the ends, or between them. */
  ends(low: number, high: number): number {
    return this.pick([low, high, this.decades(low, high), this.decades(low, high)])
  }

  pick<T>(values: readonly T[]): T {
    return values[Math.floor(this.next() * values.length)]!
  }
}

/** A direction above the plane z = 0; every other one grazes, up to 89.99° from the normal. */
function direction(random: Random): Vector {
  const degree = Math.PI / 180
  const polar = random.pick([
    () => Math.acos(random.next()),
    () => Math.PI / 2 - random.ends(0.01, 10) * degree,
  ])()
  const azimuth = random.pick([
    () => random.uniform(0, 2 * Math.PI),
    () => (random.pick([0, 1, 2, 3, 4, 5, 6, 7]) * Math.PI) / 4,
  ])()
  return [Math.sin(polar) * Math.cos(azimuth), Math.sin(polar) * Math.sin(azimuth), Math.cos(polar)]
}

/** Where a visible wavelength of some order goes; the mirror direction where that order does not propagate. */
function order(random: Random, [x, y, z]: Vector, set: { period: number; orientation: number }) {
  const shift = (random.pick([-2, -1, 1, 2, 5]) * random.uniform(0.4, 0.7)) / set.period
  const u = shift * Math.cos(set.orientation) - x
  const v = shift * Math.sin(set.orientation) - y
  const z2 = 1 - u * u - v * v
  return z2 > 1e-8 ? ([u, v, Math.sqrt(z2)] satisfies Vector) : ([-x, -y, z] satisfies Vector)
}

function randomSet(random: Random, program: Program): StabilitySet {
  const isGrating = program.longest !== undefined
  const period = isGrating ? random.ends(0.038, program.longest!) : 2
  const least = program.leastCoherence ?? (isGrating ? period / 4 : null)
  const orientation = random.pick([0, Math.PI / 2, random.uniform(-4, 4)])
  const light = direction(random)
  const [x, y, z] = light
  const view = random.pick<() => Vector>([
    () => direction(random),
    () => [-x, -y, z],
    () => light,
    () => [-x, -y, Math.max(1e-4, z + random.uniform(-0.01, 0.01))],
    () => order(random, light, { period, orientation }),
    () => order(random, light, { period, orientation }),
  ])()
  return {
    ...(isGrating && { period, height: random.ends(1e-4, HIGHEST) }),
    orientation,
    ...(program.roughness && { roughness: random.ends(...program.roughness) }),
    ...(least !== null && { coherence: random.ends(least, 1000) }),
    mesh: random.pick(['plane', 'plane', 'sphere']),
    uv: random.pick(['given', 'mirrored', 'constant']),
    scale: random.pick<Vector>([
      [1, 1, 1],
      [-1, 1, 1],
      [1, -1, 1],
      [-1, -1, -1],
      [1, 1e-3, 1],
    ]),
    unit: random.pick([1e-4, 1, 1e4]),
    light: {
      direction: light,
      distance: random.ends(1e-2, 1e2),
      ...(program.radii && { angularRadius: random.ends(...program.radii) }),
    },
    view: {
      direction: normalized(view),
      distance: random.pick([2, 5]),
      fov_deg: random.pick([0.1, 5, 40]),
    },
  }
}

/** Of Y, as a share of the picture's brightest pixel: what rounding to half floats leaves of dark colours. */
const NEGATIVE_ALLOWED = 1e-5

function isSound({ nonFinite, least, largest }: StabilityResult): boolean {
  return nonFinite === 0 && least >= -NEGATIVE_ALLOWED * Math.max(largest, 0)
}

async function draw(
  harness: HarnessHandle,
  name: string,
  sets: StabilitySet[],
): Promise<StabilityResult[]> {
  const program: StabilityProgram = PROGRAMS[name]!
  return harness.page.evaluate(([p, s]) => window.harness.drawSets(p, s), [program, sets] as [
    StabilityProgram,
    StabilitySet[],
  ])
}

function failures(name: string, sets: StabilitySet[], results: StabilityResult[]): string[] {
  return sets.flatMap((set, i) =>
    isSound(results[i]!)
      ? []
      : [JSON.stringify({ program: name, set } satisfies Case) + JSON.stringify(results[i])],
  )
}

/** SwiftShader, a stand-in for a poor GPU, is slower: every fifth of the sets of programs that differ in kind. */
const BACKENDS: { backend: 'llvmpipe' | 'swiftshader'; share: number; names: string[] }[] = [
  { backend: 'llvmpipe', share: 1, names: Object.keys(PROGRAMS) },
  {
    backend: 'swiftshader',
    share: 0.2,
    names: ['conserving', 'sharp', 'height field, baked', 'a foil', 'a harsh environment'],
  },
]

describe.each(BACKENDS)(
  'with parameters at their ends, on $backend',
  ({ backend, share, names }) => {
    let harness: HarnessHandle

    beforeAll(async () => {
      harness = await openHarness({ backend })
    })

    afterAll(async () => {
      await harness.close()
    })

    it.each(names)('radiance is finite and not negative: %s', async (name) => {
      const program = PROGRAMS[name]!
      const random = new Random(1)
      const sets = Array.from({ length: share * program.sets }, () => randomSet(random, program))
      const results = await draw(harness, name, sets)
      // Whatever fails is printed as it has to be written to stability-cases.json.
      expect(failures(name, sets, results).slice(0, 5).join('\n')).toBe('')
      // Pictures without light would show nothing.
      const lit = results.filter(({ largest }) => largest > 0).length
      expect(lit).toBeGreaterThan(0.3 * sets.length)
    })

    it('draws what once failed', async () => {
      const file = new URL('stability-cases.json', import.meta.url)
      const cases = (JSON.parse(readFileSync(file, 'utf8')) as Case[]).filter(({ program }) =>
        names.includes(program),
      )
      for (const name of new Set(cases.map(({ program }) => program))) {
        const sets = cases.filter(({ program }) => program === name).map(({ set }) => set)
        expect(failures(name, sets, await draw(harness, name, sets)).join('\n')).toBe('')
      }
    })
  },
)
