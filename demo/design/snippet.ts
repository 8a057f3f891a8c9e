import { MathUtils } from 'three'
import type { DiffractionMaterial, Foil } from '../../web'
import { constantOf } from '../../web/maps/load'

/** Code that shows a foil as the page does. name: of its files. */
export function snippet(name: string, foil: Foil, material: DiffractionMaterial): string {
  const { repeat, height, profile, map } = foil
  const load = [
    `repeat: new Vector2(${number(repeat.x)}, ${number(repeat.y)})`,
    ...(height === constantOf(map, 'height_um')[0] ? [] : [`height: ${number(height)}`]),
    ...(profile === map.sidecar.recipe['profile'] ? [] : [`profile: '${profile}'`]),
  ]
  const { metal, illuminant, method, energy, roughness, coherence, coat, coatIor, color } = material
  const settings = [
    ...[`metal: '${metal}'`, `illuminant: '${illuminant}'`],
    ...[`method: '${method}'`, `energy: '${energy}'`],
    `roughness: ${number(roughness)}, // rad, ${number(MathUtils.radToDeg(roughness))}°`,
    `coherence: ${number(coherence)}, // µm`,
    ...(coat > 0 ? [`coat: ${number(coat)}`, `coatIor: ${number(coatIor)}`] : []),
    `color: 0x${color.getHexString()}`,
  ]
  return `import { Vector2 } from 'three'
import { DiffractionMaterial, Foil } from 'three-diffraction'

// ${name}.json and its image, and the library's own tables, where the page serves them.
const foil = await Foil.load('/maps/${name}', { ${load.join(', ')} })
export const material = new DiffractionMaterial({
  surface: foil,
  mapsPath: '/maps/baked/',
${settings.map((setting) => `  ${setting.includes(' //') ? setting : `${setting},`}`).join('\n')}
})
await material.ready
`
}

/** To five significant digits. */
function number(value: number): string {
  return String(Number(value.toPrecision(5)))
}
