import { OrthographicCamera, PerspectiveCamera, Scene, Vector3, type Camera } from 'three'
import { describe, expect, it } from 'vitest'
import { jitteredProjection } from '../../web/refinement/jittered-projection'
import { pixelOffsets } from '../../web/refinement/pixel-offsets'
import { radicalInverse } from '../../web/refinement/radical-inverse'
import { drawRefinementFrame, refinementFrame } from '../../web/refinement/refinement-frame'

describe('the radical inverse', () => {
  it('mirrors digits at the point', () => {
    // 110 becomes 0.011.
    expect(radicalInverse(6)).toBe(3 / 8)
    expect(radicalInverse(0)).toBe(0)
  })
})

describe('the centres of pixels', () => {
  it.each([1, 2, 16, 64])('lie once at each offset along both axes: %s', (frames) => {
    const offsets = pixelOffsets(frames)
    const evenly = Array.from({ length: frames }, (_, i) => (i + 0.5) / frames - 0.5)
    for (const axis of [0, 1] as const)
      expect(offsets.map((offset) => offset[axis]).sort((a, b) => a - b)).toEqual(evenly)
    expect(Math.hypot(...offsets[0]!)).toBeLessThanOrEqual(Math.SQRT1_2 / frames)
  })
})

describe('a jittered projection', () => {
  const perspective = new PerspectiveCamera(40, 1.5, 0.1, 10)
  const parallel = new OrthographicCamera(-2, 2, 1, -1, 0.1, 10)
  const part = new PerspectiveCamera(40, 1, 0.1, 10)
  part.setViewOffset(200, 100, 20, 30, 50, 60)

  it.each<[string, Camera]>([
    ['perspective', perspective],
    ['parallel', parallel],
    ['part of a larger picture', part],
  ])('moves the picture by as much at any depth: %s', (_name, camera) => {
    const before = camera.projectionMatrix.clone()
    for (const z of [-1, -5]) {
      const point = (): Vector3 => new Vector3(0.2, 0.1, z).applyMatrix4(camera.projectionMatrix)
      const still = point()
      jitteredProjection(camera, 0.01, -0.02, () => {
        expect(point().x - still.x).toBeCloseTo(0.01, 12)
        expect(point().y - still.y).toBeCloseTo(-0.02, 12)
        expect(point().z).toBeCloseTo(still.z, 12)
        const there = point().applyMatrix4(camera.projectionMatrixInverse)
        expect(there.distanceTo(new Vector3(0.2, 0.1, z))).toBeLessThan(1e-9)
      })
    }
    expect(camera.projectionMatrix).toEqual(before)
  })
})

describe('the frame of a refinement', () => {
  it('is known of its scene alone, and only while it is drawn', () => {
    const [scene, other] = [new Scene(), new Scene()]
    const frame = { index: 3, count: 16 }
    const fails = (): void => {
      drawRefinementFrame(scene, frame, () => {
        expect(refinementFrame(scene)).toEqual(frame)
        expect(refinementFrame(other)).toBeNull()
        throw new Error('a shader')
      })
    }
    expect(fails).toThrow('a shader')
    expect(refinementFrame(scene)).toBeNull()
  })
})
