import { Color, Group, MathUtils, Mesh, MeshBasicMaterial, PointLight, SphereGeometry } from 'three'

/** Where the flash stands, seen from the object. */
export interface FlashPlace {
  /** From the front towards the right, rad. */
  azimuth: number
  /** Above the horizon, rad. */
  height: number
}

/** The three.js layer of the sphere that shows where the flash is: it is no part of what is lit. */
export const MARKER_LAYER = 1

const DISTANCE = 1.4
/** The sphere shows a Gaussian source out to this many standard deviations, where it has fallen to 14 %. */
const SHOWN_RADIUS = 2
const SMALLEST_SHOWN = 0.018
const HIGHEST = MathUtils.degToRad(85)

/** A movable point light of some angular size, and the small sphere that shows where it is. */
export class Flash {
  readonly object = new Group()
  readonly #light = new PointLight(0xffffff, 1, 0, 2)
  readonly #marker = new Mesh(
    new SphereGeometry(1, 32, 16),
    new MeshBasicMaterial({ color: new Color(3, 3, 3) }),
  )
  #azimuth = 0
  #height = 0

  constructor() {
    this.#light.name = 'flash'
    this.#marker.layers.set(MARKER_LAYER)
    this.object.add(this.#light, this.#marker)
    this.angularRadius = MathUtils.degToRad(0.5)
    this.#place()
  }

  /** Radiant intensity in the scene's units. */
  get intensity(): number {
    return this.#light.intensity
  }

  set intensity(value: number) {
    this.#light.intensity = value
    this.object.visible = value > 0
  }

  /** Standard deviation of the Gaussian source as the object sees it, rad. */
  get angularRadius(): number {
    return this.#light.userData['angularRadius'] as number
  }

  set angularRadius(value: number) {
    this.#light.userData['angularRadius'] = value
    const radius = DISTANCE * Math.tan(SHOWN_RADIUS * value)
    this.#marker.scale.setScalar(Math.max(radius, SMALLEST_SHOWN))
  }

  get azimuth(): number {
    return this.#azimuth
  }

  set azimuth(value: number) {
    this.#azimuth = MathUtils.euclideanModulo(value + Math.PI, 2 * Math.PI) - Math.PI
    this.#place()
  }

  get height(): number {
    return this.#height
  }

  set height(value: number) {
    this.#height = MathUtils.clamp(value, -HIGHEST, HIGHEST)
    this.#place()
  }

  #place(): void {
    const level = DISTANCE * Math.cos(this.#height)
    this.object.position.set(
      level * Math.sin(this.#azimuth),
      DISTANCE * Math.sin(this.#height),
      level * Math.cos(this.#azimuth),
    )
  }
}
