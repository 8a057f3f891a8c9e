import { DataUtils } from 'three'
import { texelFromParameter } from '../maps/axes.ts'
import { arrayOf, constantOf, type LoadedMap } from '../maps/load.ts'

/** The shortest visible wavelength, µm: where the phase of a relief is largest and most orders propagate. */
export const SHORTEST_WAVELENGTH = 0.38

/** An order that never takes more than this share of the light is not shown. */
const NEGLIGIBLE = 1e-4

/** The largest |m| that any light can be sent into: u = mλ/a is at most 2. period: µm. */
export function propagatingOrder(period: number): number {
  return Math.floor((2 * period) / SHORTEST_WAVELENGTH)
}

/**
 * The largest |m| that a surface shows: it can propagate (u = mλ/a ≤ 2), its profile's table has it, and at the
 * relief's largest phase or any smaller one it takes more than a ten-thousandth of the light.
 *
 * @param profile - a map of kind 'profile'
 * @param period - the longest on the surface, µm
 * @param height - of the relief, µm
 */
export function maxOrder(profile: LoadedMap, period: number, height: number): number {
  const tableOrder = constantOf(profile, 'max_order')[0]!
  const { spec, data } = arrayOf(profile, 'efficiency')
  const phases = spec.axes[1]!
  const largestPhase = (2 * Math.PI * 2 * height) / SHORTEST_WAVELENGTH
  const used = Math.min(Math.ceil(texelFromParameter(phases, largestPhase)) + 1, phases.size)
  const largest = (order: number): number => {
    const row = (order + tableOrder) * phases.size
    let most = 0
    for (let i = row; i < row + used; i++) most = Math.max(most, DataUtils.fromHalfFloat(data[i]!))
    return most
  }
  let order = Math.min(tableOrder, propagatingOrder(period))
  while (order > 0 && Math.max(largest(order), largest(-order)) < NEGLIGIBLE) order--
  return order
}
