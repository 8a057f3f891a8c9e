import { GratingDistribution } from './distribution'
import { refusal } from './values'

const FORMAT = 'three-diffraction/grating-distribution'
const FIELD = 'distribution'
const FIELDS = ['format', 'version', 'orientation_edges', 'frequency_edges', 'weights']
/** Some 200 000 weights. */
const MOST_BYTES = 1 << 22
/** π may have been typed as 3.1416. */
const MOST_SPAN = Math.PI + 1e-5

/**
 * A file that `precompute.foils.distribution` reads, with the same bounds. Throws a DiffractionError where it is none, or
 * too large.
 */
export async function readDistribution(file: File): Promise<GratingDistribution> {
  if (file.size > MOST_BYTES)
    throw refusal(FIELD, file.size, `a file of at most ${MOST_BYTES >> 20} MB`)
  let json: unknown
  try {
    json = JSON.parse(await file.text())
  } catch {
    throw refusal(FIELD, file.name, 'a JSON file')
  }
  return distributionOf(json)
}

function distributionOf(json: unknown): GratingDistribution {
  if (typeof json !== 'object' || json === null)
    throw refusal(FIELD, json, 'a distribution of gratings')
  const stated = json as Record<string, unknown>
  const refuse = (field: string, expected: string): never => {
    throw refusal(FIELD, stated[field], `${field}: ${expected}`)
  }
  if (stated['format'] !== FORMAT) refuse('format', `'${FORMAT}'`)
  if (stated['version'] !== 1) refuse('version', '1')
  for (const field of Object.keys(stated))
    if (!FIELDS.includes(field)) refuse(field, 'no such field')
  const edges = (field: string): number[] => {
    const values = stated[field]
    if (!isNumbers(values) || values.length < 2) return refuse(field, 'two numbers or more')
    if (values.some((value, i) => i > 0 && value <= values[i - 1]!))
      return refuse(field, 'numbers that rise')
    return values
  }
  const orientations = edges('orientation_edges')
  const frequencies = edges('frequency_edges')
  if (orientations.at(-1)! - orientations[0]! > MOST_SPAN)
    refuse('orientation_edges', 'a span of π at most')
  if (frequencies[0]! <= 0) refuse('frequency_edges', 'above 0 (1/µm)')
  const [rows, columns] = [orientations.length - 1, frequencies.length - 1]
  const weights = stated['weights']
  if (
    !Array.isArray(weights) ||
    weights.length !== rows ||
    !weights.every((row) => isNumbers(row) && row.length === columns && row.every((w) => w >= 0))
  )
    return refuse('weights', `${rows} rows of ${columns} numbers from 0, a cell between edges`)
  const all = Float64Array.from((weights as number[][]).flat())
  if (!all.some((weight) => weight > 0)) refuse('weights', 'one above 0 at least')
  return new GratingDistribution(orientations, frequencies, all)
}

function isNumbers(value: unknown): value is number[] {
  return Array.isArray(value) && value.every(Number.isFinite)
}
