import { luminance } from '../../numbers/luminance'
import type { Colour, LightSpectrum } from './light-spectrum'

/** Colour outside the display's gamut moved towards grey of the same luminance, as shaders/gamut.glsl does. */
export function gamutMapped(rgb: Colour): Colour {
  const y = luminance(...rgb)
  if (y <= 0) return [0, 0, 0]
  const lowest = Math.min(...rgb)
  const k = lowest < 0 ? lowest / (lowest - y) : 0
  return rgb.map((value) => Math.max(value + k * (y - value), 0)) as Colour
}

/** Linear sRGB of any size to 0 … 255 by Khronos' PBR neutral tone mapping, the page's own. */
export function toneMapped(rgb: Colour, exposure: number): Colour {
  const start = 0.8 - 0.04
  const desaturation = 0.15
  let c = gamutMapped(rgb).map((value) => value * exposure)
  const least = Math.min(...c)
  const offset = least < 0.08 ? least - 6.25 * least * least : 0.04
  c = c.map((value) => value - offset)
  const peak = Math.max(...c)
  if (peak >= start) {
    const d = 1 - start
    const compressed = 1 - (d * d) / (peak + d - start)
    const g = 1 - 1 / (desaturation * (peak - compressed) + 1)
    c = c.map((value) => value * (compressed / peak) * (1 - g) + compressed * g)
  }
  return c.map((value) => 255 * encoded(value)) as Colour
}

/** The colour of each of the spectrum's nanometres as a display can show it, about equally bright, 0 to 255. */
export function spectralColours(spectrum: LightSpectrum): Colour[] {
  return spectrum.wavelengths.map((_, cell) => {
    const xyz = spectrum.white(cell)
    const rgb = gamutMapped(spectrum.rgb(xyz))
    const most = Math.max(...rgb, 1e-12)
    // The ends are dim, not dark: what is drawn there has to be seen on a dark ground.
    return rgb.map((value) => 255 * encoded(Math.max(value / most, 0.045))) as Colour
  })
}

function encoded(value: number): number {
  const x = Math.min(Math.max(value, 0), 1)
  return x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055
}

export function css([r, g, b]: Colour): string {
  return `rgb(${Math.round(r)} ${Math.round(g)} ${Math.round(b)})`
}
