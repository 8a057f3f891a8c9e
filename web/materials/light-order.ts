import {
  ShaderChunk,
  type Camera,
  type DirectionalLight,
  type Light,
  type Object3D,
  type PointLight,
  type SpotLight,
} from 'three'
import { refuse } from '../errors.ts'

/** The kinds of light that diffract, in the order of the loops in three's `lights_fragment_begin`. */
export const LIGHT_LOOPS = ['POINT', 'SPOT', 'SUN', 'DIR'] as const
type LightLoop = (typeof LIGHT_LOOPS)[number]

/**
 * Puts the lights that a camera sees into the order in which three's shader goes through them: by kind as above,
 * within a kind those that cast shadows first, then those with a map, otherwise as the scene is walked.
 * The arrays are filled anew and keep their storage, so a frame allocates nothing.
 */
export class LightOrder {
  /** The lights, one entry for each call of RE_Direct. */
  readonly lights: Light[] = []
  readonly #visible: Light[] = []

  update(scene: Object3D, camera: Camera): void {
    this.#visible.length = 0
    this.#collect(scene, camera)
    sortStable(this.#visible)
    this.lights.length = 0
    for (const loop of LIGHT_LOOPS)
      for (const light of this.#visible) if (loopOf(light) === loop) this.lights.push(light)
  }

  /** As WebGLRenderer collects them: whole branches can be hidden, layers concern the object alone. */
  #collect(object: Object3D, camera: Camera): void {
    if (!object.visible) return
    if (isLight(object) && object.layers.test(camera.layers)) this.#visible.push(object)
    for (const child of object.children) this.#collect(child, camera)
  }
}

/** Throws if three's chunk no longer calls RE_Direct once in each of these loops, in this order. */
export function assertLightLoops(chunk: string = ShaderChunk.lights_fragment_begin): void {
  const loops = Array.from(
    chunk.matchAll(/i < NUM_(\w+)_LIGHTS;|(RE_Direct)\(/g),
    ([, loop, call]) => loop ?? call,
  )
  const diffracting = loops.slice(0, 2 * LIGHT_LOOPS.length)
  const expected = LIGHT_LOOPS.flatMap((loop) => [loop, 'RE_Direct'])
  const calls = loops.filter((entry) => entry === 'RE_Direct').length
  if (diffracting.join() !== expected.join() || calls !== LIGHT_LOOPS.length)
    refuse('three, lights_fragment_begin', 'loops over lights', loops, expected.join(', '))
}

/** Whether colour varies over the light or differs from grey, so that its spectrum needs three basis spectra. */
export function isTinted(light: Light): boolean {
  const { r, g, b } = light.color
  return r !== g || g !== b || hasMap(light)
}

function loopOf(light: Light): LightLoop | null {
  if ((light as Light & { isSunLight?: boolean }).isSunLight) return 'SUN'
  if ((light as Partial<DirectionalLight>).isDirectionalLight) return 'DIR'
  if ((light as Partial<SpotLight>).isSpotLight) return 'SPOT'
  if ((light as Partial<PointLight>).isPointLight) return 'POINT'
  return null
}

function isLight(object: Object3D): object is Light {
  return (object as Partial<Light>).isLight === true
}

function hasMap(light: Light): boolean {
  return Boolean((light as Partial<SpotLight>).map)
}

/** Insertion sort: scenes have few lights, and unlike Array.sort it needs no storage of its own. */
function sortStable(lights: Light[]): void {
  for (let i = 1; i < lights.length; i++) {
    const light = lights[i]!
    let j = i - 1
    for (; j >= 0 && rank(lights[j]!) < rank(light); j--) lights[j + 1] = lights[j]!
    lights[j + 1] = light
  }
}

function rank(light: Light): number {
  return (light.castShadow ? 2 : 0) + (hasMap(light) ? 1 : 0)
}
