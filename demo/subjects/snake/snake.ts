import { Group, MathUtils } from 'three'
import { DiffractionMaterial, HeightField } from '../../../web'
import { MAPS, type Subject } from '../subject'
import { flesh } from './flesh'
import { scales } from './scales'

/** A snake whose scales wear ridges like fingers, in a clear layer over dark pigment. */
export async function snake(): Promise<Subject> {
  const surface = new HeightField({ field: 'fingers', ior: 1.5, strength: 0.85 })
  const material = new DiffractionMaterial({
    surface,
    mapsPath: MAPS,
    // A degree: the roughness that was baked in.
    method: 'baked',
    roughness: 0.0175,
    environmentNodes: 8,
  })
  await material.ready
  const object = new Group()
  object.add(flesh(), scales(material))
  return {
    caption: 'A snake: clear scales over dark pigment, with ridges like fingers 0.8 µm apart.',
    object,
    material,
    surface,
    camera: [0, 2.5, 2.9],
    aspect: 1.5,
    tilt: [0, 0],
    light: { flash: 10, exposure: 1 },
    flash: { azimuth: MathUtils.degToRad(-20), height: MathUtils.degToRad(55) },
  }
}
