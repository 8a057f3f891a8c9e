import type { JsonReader } from './json.ts'
import type { ArraySpec, Dtype, MapKind } from './sidecar.ts'

type ArrayContents = readonly [rank: number, channels: number, dtype?: Dtype]

/** What each kind of map must hold, and may hold: its arrays with their channels, its constants with their counts. */
const CONTENTS: Record<
  MapKind,
  {
    arrays: Record<string, ArrayContents>
    optional?: Record<string, ArrayContents>
    constants: Record<string, number>
  }
> = {
  profile: {
    arrays: { efficiency: [3, 1] },
    constants: { max_order: 1, max_phase: 1, symmetric: 1 },
  },
  lobes: {
    arrays: { lobe: [4, 4], weights: [2, 9] },
    constants: {
      white_xyz: 3,
      xyz_to_rgb: 9,
      wavenumber_min: 1,
      wavenumber_max: 1,
      margin: 1,
      exponent_cut: 1,
      wide_lobe_nodes: 1,
    },
  },
  metals: {
    arrays: { reflectance: [3, 4] },
    constants: {},
  },
  'height-field-baked': {
    arrays: {
      modes: [4, 4],
      weights: [3, 4],
      coherent: [3, 4],
      places: [2, 4],
      powers: [3, 1],
    },
    constants: { modes: 1, u_max: 1, v_max: 1, angular_radius: 1 },
  },
  'height-field-terms': {
    arrays: {
      terms: [4, 4],
      coefficients: [3, 1],
      places: [2, 4],
      powers: [3, 1],
    },
    constants: { period_x: 1, period_y: 1, amplitude: 1, max_phase: 1, terms: 1 },
  },
  foil: {
    arrays: { grating: [3, 4] },
    optional: { normal: [3, 4, 'uint8'] },
    constants: { height_um: 1, min_frequency: 1, max_frequency: 1, tile_mm: 2 },
  },
}

export const MAP_KINDS = Object.keys(CONTENTS) as MapKind[]

/** Refuses a sidecar that lacks what its kind of map must hold, or has it otherwise. */
export function checkContents(
  kind: MapKind,
  arraysField: JsonReader,
  arrays: Record<string, ArraySpec>,
  constantsField: JsonReader,
  constants: Record<string, number[]>,
): void {
  const contents = CONTENTS[kind]
  for (const name of Object.keys(contents.arrays))
    if (arrays[name] === undefined)
      throw arraysField.field(name).refuse(`an array, in a map of ${kind}`)
  const known = { ...contents.arrays, ...contents.optional }
  for (const [name, [rank, channels, dtype]] of Object.entries(known)) {
    const spec = arrays[name]
    if (spec === undefined) continue
    const field = arraysField.field(name)
    if (spec.shape.length !== rank) throw field.field('shape').refuse(`${rank} sizes`)
    if (spec.shape.at(-1) !== channels) throw field.field('shape').refuse(`${channels} channels`)
    if (dtype !== undefined && spec.dtype !== dtype) throw field.field('dtype').refuse(dtype)
  }
  for (const [name, count] of Object.entries(contents.constants))
    if (constants[name]?.length !== count)
      throw constantsField.field(name).refuse(count === 1 ? 'a number' : `${count} numbers`)
}
