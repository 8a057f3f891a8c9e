import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import type { RefinementReport } from './harness/refinement'
import type { SceneDescription } from './harness/scene-description'
import { openHarness } from './open-harness.mjs'
import { readScene, render, type HarnessHandle } from './read-scene'

let harness: HarnessHandle

beforeAll(async () => {
  harness = await openHarness()
})

afterAll(async () => {
  await harness.close()
})

describe('progressive refinement', () => {
  let scene: SceneDescription
  let report: RefinementReport

  beforeAll(async () => {
    scene = { ...(await readScene('environment-studio')), size: [32, 32] }
    report = await harness.page.evaluate((s) => window.harness.reportRefinement(s), scene)
  })

  it('stops when the picture is finished', () => {
    expect(report.answers).toEqual([true, true, true, false, false, false])
    expect(report.drawnAfterwards).toBe(0)
  })

  it('begins anew when something has changed', () => {
    expect(report.again).toBe(0)
    expect(report.turned).toBeGreaterThan(0.1)
    expect(report.back).toBeLessThan(1e-5)
  })

  it('compiles nothing and writes no texture from frame to frame', () => {
    expect([report.linked, report.uploaded]).toEqual([0, 0])
    expect(harness.complaints).toEqual([])
  })

  it('leaves the camera and frames that stand alone as they were', () => {
    expect(report.projection).toBe(0)
    expect(report.alone).toBe(0)
  })

  it('shows pixels as the means over their area', async () => {
    // An edge of an even surface in white light: what a pixel shows is how much of it is covered.
    const edge: SceneDescription = {
      ...scene,
      size: [64, 64],
      camera: { position: [0, 0, 10], fov_deg: 20 },
      mesh: { kind: 'plane', size: [2, 2], rotation_deg: [0, 0, 20] },
      environment: { constant: [1, 1, 1] },
    }
    const fine = await render(harness, { ...edge, size: [512, 512] })
    const coverage = new Float64Array(64 * 64)
    for (const pixel of fine.covered)
      coverage[64 * Math.floor(pixel / 512 / 8) + Math.floor((pixel % 512) / 8)]! += 1 / 64
    const offBy = (shown: Float32Array): number =>
      Math.sqrt(coverage.reduce((sum, c, i) => sum + (shown[4 * i + 3]! - c) ** 2, 0))
    const single = await render(harness, edge)
    const refined = await render(harness, { ...edge, refinement: { frames: 16 } })
    expect(offBy(refined.radiance)).toBeLessThan(0.35 * offBy(single.radiance))
  })
})
