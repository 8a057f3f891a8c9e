import type { Material, Mesh, Object3D } from 'three'
import type { DiffractionMaterial, Method } from '../../web'
import type { Subject } from '../subjects/subject'
import { WHOLE } from '../view/pane'
import type { Viewer } from '../view/viewer'
import { follow, otherMaterial, otherMethod } from './other-material'
import type { Way } from './draw-radiance'
import { pictureDifference } from './picture-difference'

/** The object on show as its own method draws it, to the left of a line, and as another method does, to the right. */
export class Comparison {
  /** Where the line is, as a share of the picture's width. */
  #line = 0.5
  #subject: Subject | null = null
  #other: DiffractionMaterial | null = null
  #method: Method | null = null
  /** What the other material was last asked for. */
  #awaited: Promise<void> | null = null

  constructor(
    private readonly viewer: Viewer,
    private readonly onError: (error: unknown) => void,
  ) {}

  get isOn(): boolean {
    return this.#subject !== null
  }

  get line(): number {
    return this.#line
  }

  set line(value: number) {
    this.#line = value
    this.#split()
  }

  /** The material that draws the right part; null where the picture is whole. */
  get other(): DiffractionMaterial | null {
    return this.#other
  }

  /** Compares what draws that object with another method; null: no longer. */
  compare(subject: Subject | null): void {
    this.#subject = subject
    this.#other?.dispose()
    this.#other = null
    this.#split()
  }

  /** The relative root mean square difference of both methods' radiance on the object, as it is seen now. */
  difference(): number | null {
    const [own, other] = this.ways
    return own === undefined || other === undefined
      ? null
      : pictureDifference(this.viewer, [own, other])
  }

  /** The ways in which the object is drawn: its own, and that on the right where there is one. */
  get ways(): readonly Way[] {
    const [subject, other] = [this.#subject, this.#other]
    if (subject === null || other === null) return [WHOLE.draw]
    return [
      WHOLE.draw,
      (render) => {
        wearing(subject.object, subject.material, other, render)
      },
    ]
  }

  #split(): void {
    this.viewer.panes =
      this.#subject === null
        ? [WHOLE]
        : [
            { ...WHOLE, right: this.#line },
            { left: this.#line, right: 1, draw: this.#drawOther },
          ]
  }

  readonly #drawOther = (render: () => void): void => {
    const subject = this.#subject
    if (subject === null) return
    const { material } = subject
    const method = otherMethod(material)
    if (this.#other === null || this.#method !== method) {
      this.#method = method
      this.#other = this.#make(material, method)
    }
    follow(this.#other, material)
    this.#drawWhenReady(this.#other)
    wearing(subject.object, material, this.#other, render)
  }

  #make(material: DiffractionMaterial, method: Method): DiffractionMaterial {
    this.#other?.dispose()
    const other = otherMaterial(material, method)
    other.onError = this.onError
    return other
  }

  /** Draws again once what the other material was last asked for is there. */
  #drawWhenReady({ ready }: DiffractionMaterial): void {
    if (ready === this.#awaited) return
    this.#awaited = ready
    ready.then(
      () => {
        this.viewer.invalidate()
      },
      () => undefined,
    )
  }
}

/** Has all that wears one material wear another one meanwhile. */
function wearing(
  object: Object3D,
  material: DiffractionMaterial,
  other: DiffractionMaterial,
  act: () => void,
): void {
  const meshes: (Mesh & { material: Material })[] = []
  object.traverse((part) => {
    if (isMesh(part) && part.material === material) meshes.push(part)
  })
  for (const mesh of meshes) mesh.material = other
  try {
    act()
  } finally {
    for (const mesh of meshes) mesh.material = material
  }
}

function isMesh(part: Object3D): part is Mesh & { material: Material } {
  return 'isMesh' in part
}
