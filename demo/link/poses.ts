import { MathUtils, Spherical } from 'three'
import { DiffractionError } from '../../web'
import type { Tilt } from '../view/tilt'
import type { Viewer } from '../view/viewer'
import { ADDRESS, type Setting } from './setting'

const { degToRad, radToDeg } = MathUtils

/** How the object is held: its turns about the level axis and about the vertical, °. */
export function tiltSetting(tilt: Tilt): Setting {
  return {
    name: 'tilt',
    read: () => tilt.pose.map((angle) => rounded(radToDeg(angle))).join(','),
    write: (text) => {
      const [x, y] = numbers('tilt', text, 2).map(degToRad)
      tilt.pose = [x!, y!]
    },
  }
}

/** Where the camera stands: its angles from the front to the right and above the horizon, °, and its distance. */
export function cameraSetting({ camera, orbit }: Viewer): Setting {
  return {
    name: 'camera',
    read: () => {
      const { theta, phi, radius } = new Spherical().setFromVector3(camera.position)
      return [radToDeg(theta), 90 - radToDeg(phi), radius].map(rounded).join(',')
    },
    write: (text) => {
      const [azimuth, height, distance] = numbers('camera', text, 3)
      const place = new Spherical(distance, degToRad(90 - height!), degToRad(azimuth!)).makeSafe()
      camera.position.setFromSpherical(place)
      // Keeps it within its bounds.
      orbit.update()
    },
  }
}

/** To a thousandth: less than a pixel. */
function rounded(value: number): number {
  return Math.round(1000 * value) / 1000
}

function numbers(field: string, text: string, count: number): number[] {
  const values = text.split(',').map((part) => (part.trim() === '' ? NaN : Number(part)))
  if (values.length !== count || !values.every(Number.isFinite))
    throw new DiffractionError({
      file: ADDRESS,
      field,
      value: text,
      expected: `${count} numbers with commas between them`,
    })
  return values
}
