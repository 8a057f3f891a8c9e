import { Mesh, type BufferGeometry, type Material } from 'three'
import { backOf } from './back'

/** A sheet that bends as paper does, about its vertical middle line, with what is stuck to it. */
export class Sheet {
  /** What lies in the sheet or on it, bent with it. */
  readonly meshes: Mesh[] = []
  readonly #layers: { geometry: BufferGeometry; flat: BufferGeometry }[] = []
  #angle = 0

  /** width: that `angle` is counted over. */
  constructor(private readonly width: number) {}

  /** What the normal turns from edge to edge, rad. */
  get angle(): number {
    return this.#angle
  }

  set angle(value: number) {
    this.#angle = value
    for (const { geometry, flat } of this.#layers) this.#bend(geometry, flat)
  }

  /** Adds a part that lies flat in the plane z = 0, or a little above it; one with a back is seen from behind too. */
  add(geometry: BufferGeometry, material: Material, hasBack = false): void {
    this.#layers.push({ geometry, flat: geometry.clone() })
    this.meshes.push(new Mesh(geometry, material))
    if (hasBack) this.meshes.push(backOf(geometry))
    this.angle = this.#angle
  }

  #bend(geometry: BufferGeometry, flat: BufferGeometry): void {
    const position = geometry.getAttribute('position')
    const normal = geometry.getAttribute('normal')
    const from = flat.getAttribute('position')
    for (let i = 0; i < position.count; i++) {
      const x = from.getX(i)
      const z = from.getZ(i)
      const turn = (x / this.width) * this.#angle
      // Arc length is kept, as paper keeps it; sin(x)/x and (1 − cos x)/x tend to 1 and 0.
      const isFlat = Math.abs(this.#angle) < 1e-6
      const radius = isFlat ? 0 : this.width / this.#angle
      const middle = isFlat ? 0 : radius * (Math.cos(turn) - Math.cos(this.#angle / 4))
      const [sine, cosine] = [Math.sin(turn), Math.cos(turn)]
      position.setX(i, (isFlat ? x : radius * sine) + z * sine)
      position.setZ(i, middle + z * cosine)
      normal.setXYZ(i, sine, 0, cosine)
    }
    position.needsUpdate = normal.needsUpdate = true
    geometry.computeBoundingSphere()
  }
}
