import type { DiffractionMaterial } from '../../web'
import { MEASURED_ERRORS } from '../../web/materials/error-choice'
import { DEFAULT_SETTINGS } from '../../web/materials/options'

type Options = Partial<Record<string, string | number>>

/**
 * Largest relative root mean square error of radiance that the report has measured for a material's surface drawn as
 * the material draws it; null where it has measured none.
 */
export function measuredError(
  material: DiffractionMaterial,
  lit: { lights: boolean; environment: boolean },
): number | null {
  const { surface, method, efficiencies, wavelengthStep, environmentNodes } = material
  const name = surface.measuredAs(material)
  const drawn: Options = { method, efficiencies, wavelengthStep, environmentNodes }
  // A row says what differs from the options that a material has by itself.
  const usual: Options = { ...DEFAULT_SETTINGS, method: surface.methods[0]! }
  const errors = (['lights', 'environment'] as const)
    .filter((part) => lit[part])
    .map((part) => {
      const knob = part === 'lights' ? 'wavelengthStep' : 'environmentNodes'
      const row = MEASURED_ERRORS[name]?.[part]?.settings.find(({ options }) =>
        ['method', 'efficiencies', knob].every(
          (option) => (options[option] ?? usual[option]) === drawn[option],
        ),
      )
      return row?.rel_rmse ?? null
    })
  if (errors.length === 0 || errors.includes(null)) return null
  return Math.max(...errors.map(Number))
}
