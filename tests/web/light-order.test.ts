import {
  AmbientLight,
  DirectionalLight,
  Group,
  Light,
  PerspectiveCamera,
  PointLight,
  Scene,
  ShaderChunk,
  SpotLight,
  Texture,
  type Color,
} from 'three'
import { WebGLLights } from 'three/src/renderers/webgl/WebGLLights.js'
import type { WebGLExtensions } from 'three/src/renderers/webgl/WebGLExtensions.js'
import { SunLight } from 'three/addons/lights/SunLight.js'
import { describe, expect, it } from 'vitest'
import { assertLightLoops, isTinted, LightOrder } from '../../web/materials/light-order'

const camera = new PerspectiveCamera()

function orderOf(scene: Scene): string[] {
  const order = new LightOrder()
  order.update(scene, camera)
  return order.lights.map((light) => light.name)
}

function named<T extends Light>(light: T, name: string, castShadow = false): T {
  light.name = name
  light.castShadow = castShadow
  return light
}

/** A number of lights, each told by its colour, in an order and with shadows as a small generator has it. */
function mixedScene(seed: number): Scene {
  const scene = new Scene()
  let state = seed
  const random = (n: number): number => {
    state = (state * 48271) % 2147483647
    return state % n
  }
  for (let i = 0; i < 12; i++) {
    const light = [
      () => new PointLight(),
      () => new SpotLight(),
      () => new DirectionalLight(),
      () => new SunLight(),
      () => new AmbientLight(),
    ][random(5)]!() as Light
    light.color.setRGB(i + 1, 0, 0)
    light.name = String(i + 1)
    light.castShadow = !(light instanceof AmbientLight) && random(2) === 1
    if (light instanceof SpotLight && random(2) === 1) light.map = new Texture()
    const parent = random(2) === 1 ? new Group() : scene
    if (parent !== scene) scene.add(parent)
    parent.add(light)
  }
  scene.updateMatrixWorld()
  return scene
}

/** WebGLLights asks only whether there is an extension. */
const extensions = { has: () => true } as unknown as WebGLExtensions

describe('the order of lights', () => {
  it.each([1, 2, 3, 4, 5, 6, 7, 8])("is three's own, scene %i", (seed) => {
    const scene = mixedScene(seed)
    const collected: Light[] = []
    scene.traverse((object) => {
      if (object instanceof Light) collected.push(object)
    })
    const threes = new WebGLLights(extensions)
    threes.setup(collected)
    const { point, spot, sun, directional } = threes.state
    const uniforms = [...point, ...spot, ...sun, ...directional] as { color: Color }[]
    const expected = uniforms.map(({ color }) => String(color.r))
    expect(orderOf(scene)).toEqual(expected)
  })

  it('leaves out what is hidden or in layers the camera does not see', () => {
    const scene = new Scene()
    const hidden = new Group()
    hidden.visible = false
    hidden.add(named(new PointLight(), 'in a hidden group'))
    const elsewhere = named(new PointLight(), 'in another layer')
    elsewhere.layers.set(3)
    const child = named(new PointLight(), 'child of it')
    elsewhere.add(child)
    scene.add(hidden, elsewhere, named(new PointLight(), 'seen'))
    expect(orderOf(scene)).toEqual(['child of it', 'seen'])
  })

  it('follows a scene that changes', () => {
    const scene = new Scene()
    const order = new LightOrder()
    const [a, b] = [named(new PointLight(), 'a'), named(new PointLight(), 'b')]
    scene.add(a, b)
    order.update(scene, camera)
    b.castShadow = true
    order.update(scene, camera)
    expect(order.lights).toEqual([b, a])
    scene.remove(a)
    order.update(scene, camera)
    expect(order.lights).toEqual([b])
  })
})

describe("three's loops over lights", () => {
  it('are as the shader counts them', () => {
    expect(() => {
      assertLightLoops()
    }).not.toThrow()
  })

  it('are refused where their order or number changed', () => {
    const chunk = ShaderChunk.lights_fragment_begin
    const swapped = chunk.replaceAll('NUM_SPOT_LIGHTS;', 'NUM_DIR_LIGHTS;')
    const twice = chunk.replace('RE_Direct( directLight', 'RE_Direct( a ); RE_Direct( directLight')
    for (const changed of [swapped, twice, ''])
      expect(() => {
        assertLightLoops(changed)
      }).toThrow('lights_fragment_begin')
  })
})

it('tells a tinted light from a grey one', () => {
  expect(isTinted(new PointLight(0x808080, 3))).toBe(false)
  expect(isTinted(new PointLight(0xffeedd))).toBe(true)
  const spot = new SpotLight()
  spot.map = new Texture()
  expect(isTinted(spot)).toBe(true)
})
