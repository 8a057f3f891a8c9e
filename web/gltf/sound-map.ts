import { refuse } from '../errors.ts'
import type { LoadedMap } from '../maps/load.ts'
import type { ArraySpec, Dtype, MapKind, Sidecar } from '../maps/sidecar.ts'

/** More would only repeat the spectra's own nanometres. */
const MOST_NODES = 401
/** Finer spectra than any colour-matching function is measured in. */
const MOST_WAVELENGTHS = 4096
/** As many as baking makes at most. */
const MOST_CELLS = 512

/** What has to hold, where it does not, and what is expected there. */
type Rule = [holds: boolean, field: string, value: unknown, expected: string]
type Arrays = Sidecar['arrays']
type Constants = Sidecar['constants']

/**
 * What readers of a map rely on beyond what its kind asks of every map, so that a stranger's neither keeps them busy without
 * end nor leads them astray: sizes that agree, and that go no further than baked ones can.
 */
const RULES: Record<MapKind, (arrays: Arrays, constants: Constants) => Rule[]> = {
  profile: ({ efficiency }, { max_order }) => {
    const { shape, axes } = efficiency!
    const order = max_order![0]!
    const [orders] = axes
    return [
      typed('efficiency', efficiency!, 'float16'),
      tabled('efficiency', efficiency!),
      [
        shape[0] === 2 * order + 1,
        'constants.max_order',
        order,
        `half of ${shape[0]!} rows but one`,
      ],
      [
        orders?.first === -order && orders.last === order,
        'arrays.efficiency.axes[0]',
        orders,
        'orders from −max_order to max_order',
      ],
    ]
  },
  lobes: ({ lobe, weights }, { wide_lobe_nodes }) => [
    typed('lobe', lobe!, 'float16'),
    tabled('lobe', lobe!),
    typed('weights', weights!, 'float32'),
    tabled('weights', weights!),
    sized('weights', weights!, 0, 2, MOST_WAVELENGTHS),
    whole('constants.wide_lobe_nodes', wide_lobe_nodes![0]!, MOST_NODES),
  ],
  metals: ({ reflectance }) => [
    typed('reflectance', reflectance!, 'float16'),
    tabled('reflectance', reflectance!),
    sized('reflectance', reflectance!, 1, 2, Infinity),
  ],
  foil: () => [],
  'height-field-terms': ({ terms, coefficients, ...arrays }, constants) => {
    const count = constants.terms![0]!
    const pairs = Math.ceil(count / 2)
    return [
      positive('period_x', constants),
      positive('period_y', constants),
      tabled('coefficients', coefficients!),
      [
        coefficients!.shape[0] === count,
        'constants.terms',
        count,
        'as many as rows of coefficients',
      ],
      sized('terms', terms!, 0, pairs, pairs),
      [
        terms!.shape[1]! % 2 === 1,
        'arrays.terms.shape',
        terms!.shape,
        'an odd number of lines along y',
      ],
      ...cells(arrays),
    ]
  },
  'height-field-baked': ({ modes, weights, coherent, ...arrays }) => [
    typed('modes', modes!, 'float16'),
    typed('coherent', coherent!, 'float16'),
    tabled('coherent', coherent!),
    sized('modes', modes!, 0, 3 * weights!.shape[0]!, 3 * weights!.shape[0]!),
    ...cells(arrays),
  ],
}

/** The cells of a relief's spectrum, as every map of a height field has them. */
function cells({ places, powers }: Arrays): Rule[] {
  const [count] = places!.shape
  return [
    sized('places', places!, 0, 1, MOST_CELLS),
    tabled('powers', powers!),
    sized('powers', powers!, 0, count!, count!),
    sized('powers', powers!, 1, 2, Infinity),
  ]
}

function typed(name: string, { dtype }: ArraySpec, expected: Dtype): Rule {
  return [dtype === expected, `arrays.${name}.dtype`, dtype, expected]
}

function tabled(name: string, { axes }: ArraySpec): Rule {
  return [axes.length > 0, `arrays.${name}.axes`, axes, 'the axes of the table']
}

function sized(name: string, { shape }: ArraySpec, axis: number, min: number, max: number): Rule {
  const size = shape[axis]!
  const range = min === max ? `${min}` : `${min} to ${max}`
  return [size >= min && size <= max, `arrays.${name}.shape[${axis}]`, size, range]
}

function positive(name: string, constants: Constants): Rule {
  const value = constants[name]![0]!
  return [value > 0, `constants.${name}`, value, 'a number above 0']
}

function whole(field: string, value: number, max: number): Rule {
  const holds = Number.isInteger(value) && value >= 1 && value <= max
  return [holds, field, value, `a whole number from 1 to ${max}`]
}

/** A recipe is compared with settings, and told in errors. */
function writable(recipe: unknown): Rule {
  let holds = true
  try {
    JSON.stringify(recipe)
  } catch {
    holds = false
  }
  return [holds, 'recipe', recipe, 'what is not nested too deep']
}

/** The map, if its readers can rely on it. */
export function expectSound(map: LoadedMap): LoadedMap {
  const { kind, arrays, constants, recipe } = map.sidecar
  for (const [holds, field, value, expected] of [
    writable(recipe),
    ...RULES[kind](arrays, constants),
  ])
    if (!holds) refuse(`${map.url}.json`, field, value, expected)
  return map
}
