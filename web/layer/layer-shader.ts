import { REVISION } from 'three'
import layer from '../../shaders/layer.glsl?raw'
import { refuse } from '../errors.ts'
import { resolveIncludes } from '../glsl/include.ts'
import { surfaceShaders } from '../glsl/surface-shaders.ts'
import type { Surface } from '../surfaces/surface.ts'

/** A line of three's fragment stage, and what comes before or after it. */
interface Insertion {
  anchor: string
  before?: string
  after?: string
}

const INSERTIONS = (surface: Surface): Insertion[] => [
  {
    anchor: '#include <clipping_planes_pars_fragment>',
    after: resolveIncludes(layer, surfaceShaders(surface)),
  },
  {
    anchor: '#include <lights_fragment_begin>',
    before: 'beginLayer(normal, faceDirection);',
  },
  {
    anchor: '#include <aomap_fragment>',
    after: [
      '#ifdef USE_AOMAP',
      'addDiffractedEnvironment(geometryViewDir, ambientOcclusion);',
      '#else',
      'addDiffractedEnvironment(geometryViewDir, 1.0);',
      '#endif // USE_AOMAP',
    ].join('\n'),
  },
  {
    anchor: 'vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;',
    after: [
      'outgoingLight = layered(outgoingLight);',
      // Glass has the opacity of what is seen through it; metal on it has its own.
      '#ifdef USE_TRANSMISSION',
      'material.transmissionAlpha = mix(material.transmissionAlpha, 1.0, layerShare());',
      '#endif // USE_TRANSMISSION',
    ].join('\n'),
  },
]

/**
 * The fragment stage of MeshStandardMaterial or MeshPhysicalMaterial with a surface on top.
 *
 * @param fragment - three's, as others may have changed it
 * @throws DiffractionError where a line that this rests on is missing, or stands there twice: under another version of
 * three, or since a hook took it out
 */
export function layeredFragment(fragment: string, surface: Surface): string {
  return INSERTIONS(surface).reduce((text, { anchor, before = '', after = '' }) => {
    const parts = text.split(anchor)
    if (parts.length !== 2)
      refuse(
        `three r${REVISION}, fragment stage of MeshPhysicalMaterial`,
        anchor,
        `${parts.length - 1} times there`,
        'this line, once',
      )
    return parts.join(`${before}\n${anchor}\n${after}`)
  }, fragment)
}
