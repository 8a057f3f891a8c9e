import { Vector3 } from 'three'
import type { Demo } from '../demo'
import { EnvironmentLight } from './optics/environment-light'
import { frameOf, type PickedPoint } from './picked-point'
import { pointOptics, type PointOptics, type SpectralTables } from './point-optics'

/** The optics of a point of the object on show, under the flash and to the camera as they are now. */
export function opticsAt(
  { subject, flash, viewer }: Demo,
  tables: SpectralTables,
  point: PickedPoint,
): PointOptics {
  const eye = viewer.camera.getWorldPosition(new Vector3())
  return pointOptics(subject, tables, point, frameOf(point, eye), {
    eye,
    flash: {
      position: flash.object.getWorldPosition(new Vector3()),
      intensity: flash.intensity,
      angularRadius: flash.angularRadius,
    },
  })
}

let last: { key: string; light: EnvironmentLight } | null = null

/** The environment on show, as it is turned and scaled now; null where there is none. */
export function environmentLight({ viewer, surroundings }: Demo): EnvironmentLight | null {
  const { loaded } = surroundings
  if (loaded === null) return null
  const { environmentRotation, environmentIntensity } = viewer.scene
  const key = `${loaded.texture.uuid} ${environmentRotation.toArray().join()} ${environmentIntensity}`
  if (last?.key !== key)
    last = {
      key,
      light: new EnvironmentLight(loaded.texture, environmentRotation, environmentIntensity),
    }
  return last.light
}
