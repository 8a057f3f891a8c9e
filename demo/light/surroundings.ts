import type { Scene } from 'three'
import { loadEnvironment, type Environment, type EnvironmentName } from './environments'

/** The background is dimmer than the light it stands for, so that the object stays what one looks at. */
const BACKGROUND_SHARE = 0.2
const BACKGROUND_BLUR = 0.45

/**
 * Mean luminance that environments are brought nearer to, half the way in stops: their files' scales are up to whoever
 * took them, but a night may stay darker than a day.
 */
const MEAN_LUMINANCE = 0.7

/** What surrounds a scene: an environment that lights it and, blurred, is its background. */
export class Surroundings {
  #chosen: EnvironmentName | 'none' = 'none'
  #loaded: Environment | null = null
  #brightness = 1

  constructor(private readonly scene: Scene) {
    scene.backgroundBlurriness = BACKGROUND_BLUR
  }

  get chosen(): EnvironmentName | 'none' {
    return this.#chosen
  }

  /** What is known of the environment in use; null for none. */
  get loaded(): Environment | null {
    return this.#loaded
  }

  /** Shows an environment as soon as it is loaded, unless another has been chosen by then. */
  async choose(name: EnvironmentName | 'none'): Promise<void> {
    const before = this.#chosen
    this.#chosen = name
    try {
      const environment = name === 'none' ? null : await loadEnvironment(name)
      if (this.#chosen !== name) return
      this.#loaded = environment
      this.scene.environment = this.scene.background = environment?.texture ?? null
      this.#scale()
    } catch (error) {
      if (this.#chosen === name) this.#chosen = before
      throw error
    }
  }

  /** Factor on the environment's radiance, beside what brings environments nearer to each other. */
  get brightness(): number {
    return this.#brightness
  }

  set brightness(value: number) {
    this.#brightness = value
    this.#scale()
  }

  /** Turn about the vertical, rad. */
  get turn(): number {
    return this.scene.environmentRotation.y
  }

  set turn(value: number) {
    this.scene.environmentRotation.y = value
    this.scene.backgroundRotation.y = value
  }

  #scale(): void {
    const mean = this.#loaded?.mean ?? MEAN_LUMINANCE
    const factor = this.#brightness * Math.sqrt(MEAN_LUMINANCE / mean)
    this.scene.environmentIntensity = factor
    this.scene.backgroundIntensity = BACKGROUND_SHARE * factor
  }
}
