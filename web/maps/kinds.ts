import type { JsonReader } from './json.ts'
import type { ArraySpec, Dtype, MapKind } from './sidecar.ts'

interface ArrayContents {
  rank: number
  channels: number
  dtype?: Dtype
}

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
    arrays: { efficiency: { rank: 3, channels: 1 } },
    constants: { max_order: 1, max_phase: 1, symmetric: 1 },
  },
  lobes: {
    arrays: { lobe: { rank: 4, channels: 4 }, weights: { rank: 2, channels: 9 } },
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
    arrays: { reflectance: { rank: 3, channels: 4 } },
    constants: {},
  },
  'height-field-baked': {
    arrays: {
      modes: { rank: 4, channels: 4 },
      weights: { rank: 3, channels: 4 },
      coherent: { rank: 3, channels: 4 },
      places: { rank: 2, channels: 4 },
      powers: { rank: 3, channels: 1 },
    },
    constants: { modes: 1, u_max: 1, v_max: 1, angular_radius: 1 },
  },
  'height-field-terms': {
    arrays: {
      terms: { rank: 4, channels: 4 },
      coefficients: { rank: 3, channels: 1 },
      places: { rank: 2, channels: 4 },
      powers: { rank: 3, channels: 1 },
    },
    constants: { period_x: 1, period_y: 1, amplitude: 1, max_phase: 1, terms: 1 },
  },
  foil: {
    arrays: { grating: { rank: 3, channels: 4 } },
    optional: { normal: { rank: 3, channels: 4, dtype: 'uint8' } },
    constants: { height_um: 1, min_frequency: 1, max_frequency: 1, tile_mm: 2 },
  },
}

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
  for (const [name, { rank, channels, dtype }] of Object.entries(known)) {
    const spec = arrays[name]
    if (spec === undefined) continue
    if (spec.shape.length !== rank)
      throw arraysField.field(name).field('shape').refuse(`${rank} sizes`)
    if (spec.shape.at(-1) !== channels)
      throw arraysField.field(name).field('shape').refuse(`${channels} channels`)
    if (dtype !== undefined && spec.dtype !== dtype)
      throw arraysField.field(name).field('dtype').refuse(dtype)
  }
  for (const [name, count] of Object.entries(contents.constants))
    if (constants[name]?.length !== count)
      throw constantsField.field(name).refuse(count === 1 ? 'a number' : `${count} numbers`)
}
