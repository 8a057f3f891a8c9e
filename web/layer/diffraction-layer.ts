import type {
  Camera,
  BufferGeometry,
  IUniform,
  MeshPhysicalMaterial,
  MeshStandardMaterial,
  Object3D,
  Scene,
  Texture,
  WebGLRenderer,
} from 'three'
import { checkEnvironment } from '../environment/environment-map.ts'
import { refuse, type DiffractionError } from '../errors.ts'
import type { LoadedMap } from '../maps/load.ts'
import { ChosenOptics } from '../materials/chosen-optics.ts'
import { Defines } from '../materials/defines.ts'
import { choose } from '../materials/features.ts'
import { assertLightLoops } from '../materials/light-order.ts'
import { DEFAULT_SETTINGS, GAMUTS, type Gamut } from '../materials/options.ts'
import { SceneOptics } from '../materials/scene-optics.ts'
import type { Feature, OpticsSettings, Surface } from '../surfaces/surface.ts'
import { angularRadius, oneOf, within } from '../validation.ts'
import { intercept } from './intercept.ts'
import { LayerDefines } from './layer-defines.ts'
import { layeredFragment } from './layer-shader.ts'

const NAME = 'diffractionLayer'

/** What a layer can be made on; MeshPhysicalMaterial is one of them. */
export type BaseMaterial = MeshStandardMaterial | MeshPhysicalMaterial

interface Marks {
  isMeshStandardMaterial: boolean
  isNodeMaterial: boolean
}

/** As in DiffractionMaterial where nothing else is said. */
export interface DiffractionLayerSettings extends OpticsSettings {
  /** What diffracts: a Grating, a Foil, a HeightField. */
  surface: Surface
  /** Share of the surface's own strength, 0 to 1 (default): what is left shows the material below. */
  strength: number
  /** Largest relative root mean square error of radiance for which method and knobs are chosen; null: as given. */
  maxError: number | null
  /** Radius (standard deviation, rad) of lights that state none in `userData.angularRadius`; null, points, by default. */
  lightAngularRadius: number | null
  /**
   * The environment that diffracts, unfiltered; null (default): the material's `envMap`, or else the scene's. It has the
   * intensity and the turn of the material's own if there is one.
   */
  envMap: Texture | null
  /** Whether a flat mesh under an environment may read a table in place of the nodes. */
  planarEnvironment: boolean
  /** Whether the layer is there at all. */
  diffraction: boolean
  /** Whether colours are moved into the display's gamut ('map') or left as sums ('signed'). */
  gamut: Gamut
  /** Told of tables that could not be loaded; prints to the console by default. */
  onError: (error: DiffractionError) => void
}

/** What a layer is made of: its surface, and what differs from the defaults. */
export interface DiffractionLayerOptions extends Partial<DiffractionLayerSettings> {
  surface: Surface
  /** Folder of the baked tables, with its slash; 'maps/baked/' by default. */
  mapsPath?: string
  /** As of DiffractionMaterial. */
  maps?: Readonly<Record<string, LoadedMap>>
}

const layers = new WeakMap<BaseMaterial, DiffractionLayer>()

/**
 * Lays a diffracting surface on a MeshStandardMaterial or MeshPhysicalMaterial, in place: where it diffracts its light
 * takes the place of the material's own (emission and transmitted light among it, for metal lies over them), under the
 * material's clearcoat and sheen. Normal and bump maps, shadows, fog, instancing and what else three does go on working,
 * and so do hooks of others, set before or later.
 *
 * A clone of the material has no layer.
 *
 * @param material - on which the surface lies; it is changed, and {@link DiffractionLayer.remove} undoes that
 * @param options - the surface, and what differs from the defaults
 * @throws DiffractionError for another kind of material, one that has a layer, or an option that is refused
 */
export function diffractionLayer(
  material: BaseMaterial,
  options: DiffractionLayerOptions,
): DiffractionLayer {
  // Node materials have all marks of the material that they stand for.
  const { isMeshStandardMaterial, isNodeMaterial } = material as Partial<Marks>
  if (isMeshStandardMaterial !== true || isNodeMaterial === true)
    refuse(
      NAME,
      'material',
      material.type,
      'a MeshStandardMaterial or a MeshPhysicalMaterial, no node material',
    )
  if (layers.has(material))
    refuse(NAME, 'material', 'one with a layer', 'one without, or remove() first')
  const layer = new DiffractionLayer(material, options)
  layers.set(material, layer)
  return layer
}

/** A surface on a material: what {@link diffractionLayer} gives. */
export class DiffractionLayer {
  readonly #material: BaseMaterial
  readonly #uniforms: Record<string, IUniform> = { uLayerStrength: { value: 1 } }
  readonly #scene: SceneOptics
  readonly #chosen: ChosenOptics
  /** Null before the options are looked at, and again when the layer is gone. */
  #defines: LayerDefines | null = null
  readonly #restore: (() => void)[]
  #own: Pick<
    DiffractionLayerSettings,
    'lightAngularRadius' | 'envMap' | 'planarEnvironment' | 'gamut' | 'onError'
  > = {
    lightAngularRadius: null,
    envMap: null,
    planarEnvironment: true,
    gamut: 'map',
    onError: (error) => {
      console.error(error)
    },
  }

  /** Use {@link diffractionLayer}. */
  constructor(
    material: BaseMaterial,
    { surface, mapsPath = 'maps/baked/', maps = {}, ...options }: DiffractionLayerOptions,
  ) {
    assertLightLoops()
    this.#material = material
    const defines = new Defines((values) => {
      this.#defines?.use(values)
    })
    this.#scene = new SceneOptics(NAME, defines, this.#uniforms)
    this.#chosen = new ChosenOptics(
      {
        name: NAME,
        useSurface: (used, isNew) => {
          this.#scene.useSurface(used, isNew)
          if (isNew) material.needsUpdate = true
        },
        useOptics: (optics) => {
          this.#scene.useOptics(optics)
        },
        onError: (error) => {
          this.#own.onError(error)
        },
      },
      surface,
      mapsPath,
      maps,
    )
    // Whatever is refused is refused before anything of the material is touched.
    this.set(options)
    this.#scene.useSurface(surface, true)
    defines.setAll({ LAYER: true, USE_UV: true, GAMUT_MAPPED: this.#own.gamut === 'map' })
    this.#chosen.begin()
    this.#defines = new LayerDefines(material)
    this.#defines.use(defines.values)
    this.#restore = [
      intercept<Parameters<BaseMaterial['onBeforeCompile']>, unknown>(
        material,
        'onBeforeCompile',
        (next, shader, renderer) => {
          next(shader, renderer)
          shader.fragmentShader = layeredFragment(shader.fragmentShader, this.#chosen.surface)
          Object.assign(shader.uniforms, this.#uniforms)
        },
      ),
      intercept<[], string>(
        material,
        'customProgramCacheKey',
        (next) => `${next()} ${NAME} ${this.#chosen.surface.name}`,
      ),
      intercept<Parameters<BaseMaterial['onBeforeRender']>, unknown>(
        material,
        'onBeforeRender',
        (next, ...draw) => {
          next(...draw)
          const [renderer, scene, camera, geometry, object] = draw
          this.#follow(renderer, scene, camera, geometry, object)
        },
      ),
    ]
    material.addEventListener('dispose', this.#dispose)
  }

  /** Resolves when all tables are there and in use; rejects with a DiffractionError. */
  get ready(): Promise<void> {
    return this.#chosen.ready
  }

  /** What holds now, chosen by `maxError` or given. */
  get settings(): Readonly<DiffractionLayerSettings> {
    const { settings, surface, maxError } = this.#chosen
    const strength = this.#uniforms.uLayerStrength!.value as number
    return { ...settings, ...this.#own, surface, maxError, strength, diffraction: this.#scene.isOn }
  }

  /**
   * Changes settings. Those that need other tables are taken over when these have come.
   *
   * @param settings - those that change
   * @throws DiffractionError that names the first that is unknown or out of range; those before it are set
   */
  set(settings: Partial<DiffractionLayerSettings>): void {
    for (const [name, value] of Object.entries(settings)) this.#set(name, value)
  }

  /** What is compiled in, what is left out, and why. */
  explain(): Feature[] {
    const { state, error, settings, features } = this.#chosen
    return [
      ...this.#scene.explain(state, error, settings),
      ...features,
      choose('gamut mapping', this.#own.gamut === 'map', "gamut is 'map'", "gamut is 'signed'"),
    ]
  }

  /** Takes the layer off: the material is as it would be without. Its textures are freed. */
  remove(): void {
    if (this.#defines === null) return
    this.#defines.remove()
    this.#defines = null
    for (const restore of this.#restore) restore()
    layers.delete(this.#material)
    this.#material.removeEventListener('dispose', this.#dispose)
    this.#dispose()
  }

  #set(name: string, value: unknown): void {
    const own = this.#own
    switch (name) {
      case 'surface':
        this.#chosen.surface = value as Surface
        break
      case 'strength':
        this.#uniforms.uLayerStrength!.value = within(NAME, name, value, 0, 1)
        break
      case 'maxError':
        this.#chosen.maxError = value as number | null
        break
      case 'lightAngularRadius':
        own.lightAngularRadius = value === null ? null : angularRadius(NAME, name, value)
        break
      case 'envMap':
        if (value !== null) checkEnvironment(value as Texture, NAME)
        own.envMap = value as Texture | null
        break
      case 'planarEnvironment':
        own.planarEnvironment = value as boolean
        break
      case 'diffraction':
        this.#scene.isOn = value as boolean
        break
      case 'gamut':
        own.gamut = oneOf(NAME, name, value, GAMUTS)
        this.#scene.defines.set('GAMUT_MAPPED', own.gamut === 'map')
        break
      case 'onError':
        own.onError = value as DiffractionLayerSettings['onError']
        break
      default:
        if (!(name in DEFAULT_SETTINGS))
          refuse(
            NAME,
            'option',
            name,
            [...Object.keys(this.settings), 'mapsPath', 'maps'].join(', '),
          )
        this.#chosen.set(name as keyof OpticsSettings, value as never)
    }
  }

  #follow(
    renderer: WebGLRenderer,
    scene: Scene,
    camera: Camera,
    geometry: BufferGeometry,
    object: Object3D,
  ): void {
    const material = this.#material
    const map = this.#own.envMap ?? material.envMap
    // As three has it: an environment of the material's own has its own intensity and turn.
    const isOwn = material.envMap !== null
    this.#chosen.follow()
    // Where three finds a program that it had before, no hook is run: the uniforms that it kept may be those of another
    // surface, of a layer that is gone, or of the bare material.
    const { uniforms } = renderer.properties.get(material) as { uniforms?: object }
    if (uniforms !== undefined) Object.assign(uniforms, this.#uniforms)
    this.#scene.follow({
      renderer,
      scene,
      camera,
      geometry,
      object,
      side: material.side,
      settings: this.#chosen.settings,
      environment:
        map === null
          ? null
          : {
              map,
              intensity: isOwn ? material.envMapIntensity : scene.environmentIntensity,
              rotation: isOwn ? material.envMapRotation : scene.environmentRotation,
            },
      obstacle: this.#planarObstacle(),
      lightRadius: this.#own.lightAngularRadius ?? 0,
    })
  }

  #planarObstacle(): string | null {
    const { normalMap, bumpMap, displacementMap, flatShading } = this.#material
    if (!this.#own.planarEnvironment) return 'planarEnvironment is false'
    if (normalMap !== null || bumpMap !== null || displacementMap !== null)
      return 'a map bends the normals'
    return flatShading ? 'flatShading takes normals from the triangles' : null
  }

  readonly #dispose = (): void => {
    this.#scene.dispose()
  }
}
