import { describe, expect, it } from 'vitest'
import { measuredError } from '../../demo/compare/measured-error'
import { DiffractionMaterial, Grating, type DiffractionMaterialOptions } from '../../web'
import report from '../../docs/report/report.json'

const LIGHTS = { lights: true, environment: false }
const ENVIRONMENT = { lights: false, environment: true }

/** Its tables are never fetched: what is asked for rests on the settings alone. */
function material(options: Partial<DiffractionMaterialOptions>): DiffractionMaterial {
  const made = new DiffractionMaterial({
    surface: new Grating({ period: 1.6, height: 0.12 }),
    ...options,
  })
  made.onError = () => undefined
  made.ready.catch(() => undefined)
  return made
}

/** Largest error over the report's own rows of sharp gratings in environments. */
function worst(method: string, nodes: number | undefined): number {
  const rows = report.rows.filter(
    (row) =>
      row.scene.startsWith('environment-') &&
      row.method === method &&
      (row.knobs as { environment_nodes?: number }).environment_nodes === nodes,
  )
  expect(rows.length).toBeGreaterThan(1)
  return Math.max(...rows.map(({ rel_rmse }) => rel_rmse))
}

describe('the error that the page tells', () => {
  it('is at least that of every scene of the report that is drawn so', () => {
    expect(measuredError(material({}), ENVIRONMENT)).toBeGreaterThanOrEqual(
      worst('closed-form', undefined),
    )
    const loop = material({ method: 'wavelength-loop', environmentNodes: 21 })
    expect(measuredError(loop, ENVIRONMENT)).toBeGreaterThanOrEqual(worst('wavelength-loop', 21))
  })

  it('is another for what is drawn otherwise', () => {
    const errors = [
      material({}),
      material({ environmentNodes: 24 }),
      material({ roughness: 0.01 }),
    ].map((drawn) => measuredError(drawn, ENVIRONMENT))
    expect(new Set(errors).size).toBe(3)
    expect(measuredError(material({}), LIGHTS)).not.toBe(errors[0])
  })

  it('is none where nothing was measured, or nothing shines', () => {
    expect(measuredError(material({ environmentNodes: 23 }), ENVIRONMENT)).toBeNull()
    expect(measuredError(material({}), { lights: false, environment: false })).toBeNull()
  })
})
