import { arrayOf, constantOf, valuesOf, type LoadedMap } from '../../../web/maps/load'

/** η_m(φ): the scalar efficiency of an order at a phase depth in rad. */
export type Efficiency = (order: number, phase: number) => number

/** As shaders/efficiency.glsl reads it: linear between phases, held at the last one; 0 for orders beyond the table. */
export function efficiencyOf(profile: LoadedMap): Efficiency {
  const array = arrayOf(profile, 'efficiency')
  const values = valuesOf(array)
  const phases = array.spec.axes[1]!
  const lastOrder = constantOf(profile, 'max_order')[0]!
  return (order, phase) => {
    if (Math.abs(order) > lastOrder) return 0
    const x = Math.sqrt(Math.min(phase / phases.last, 1)) * (phases.size - 1)
    const column = Math.min(Math.floor(x), phases.size - 2)
    const at = (order + lastOrder) * phases.size + column
    return values[at]! + (x - column) * (values[at + 1]! - values[at]!)
  }
}
