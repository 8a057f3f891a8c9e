import { make } from '../../ui/elements'
import { css, toneMapped } from '../optics/display'
import type { Colour } from '../optics/light-spectrum'
import type { PointOptics } from '../point-optics'
import type { Radiance } from '../radiance'
import { Block } from './block'
import { Chart, WAVELENGTH_AXIS, type ChartAxis } from './chart'
import { number } from './numbers'
import { svg } from './svg'

/** What the renderer shows at the point: linear sRGB of all, and of what the flash adds. */
export interface RenderedColour {
  all: Colour
  flash: Colour
}

const CURVES = ['flash', 'environment', 'illuminant'] as const

/** Spectral radiance that reaches the eye, and its colours beside what is rendered. */
export class Spectra {
  readonly block: Block
  readonly #chart = new Chart(190)
  readonly #swatches = make('div', 'swatches')

  constructor() {
    const key = make('p', 'key', ...CURVES.map((name) => make('span', `key-${name}`, KEYS[name])))
    this.block = new Block('Spectra', true, this.#chart.element, key, this.#swatches)
  }

  show(
    { tables }: PointOptics,
    flash: Radiance,
    environment: Radiance | null,
    colours: readonly Colour[],
  ): void {
    if (!this.block.isOpen) return
    const { spectrum, illuminant } = tables
    const curves = {
      flash: values(flash, illuminant),
      environment: environment && values(environment, illuminant),
      illuminant: Array.from(illuminant),
    }
    const most = Math.max(...curves.flash, ...(curves.environment ?? [0]), 1e-9)
    const step = 10 ** Math.floor(Math.log10(most))
    const y: ChartAxis = {
      ...{ from: 0, to: most * 1.05, label: 'spectral radiance, relative' },
      ticks: [0, 1, 2, 4, 6, 8].map((tick) => tick * step).filter((tick) => tick <= most),
      write: (value) => number(value, 1),
    }
    const points = (list: ArrayLike<number>, scale = 1): [number, number][] =>
      Array.from({ length: list.length }, (_, i) => [
        380 + (400 * i) / (list.length - 1),
        list[i]! * scale,
      ])
    this.#chart.draw(
      WAVELENGTH_AXIS,
      y,
      ...spectrumBar(this.#chart, colours, y),
      // As tall as the others, since it has no radiance of its own.
      this.#chart.curve(WAVELENGTH_AXIS, y, points(curves.illuminant, most), 'illuminant'),
      ...(curves.environment === null
        ? []
        : [this.#chart.curve(WAVELENGTH_AXIS, y, points(curves.environment), 'environment')]),
      this.#chart.curve(WAVELENGTH_AXIS, y, points(curves.flash), 'flash'),
    )
    const peak = (list: ArrayLike<number>): string => {
      const all = Array.from(list)
      const highest = Math.max(...all)
      if (highest < 1e-6) return 'none'
      const at = all.indexOf(highest)
      return `highest ${number(highest)} at ${Math.round(380 + (400 * at) / (all.length - 1))} nm`
    }
    const whole = spectrum.wavelengths.length
    this.block.describe(
      `Light that the point sends to the eye, over 380 to 780 nm (${whole} wavelengths); 1 is a white mirror’s under irradiance 1. ` +
        `From the flash: ${peak(curves.flash)}; from the environment: ${curves.environment === null ? 'none' : peak(curves.environment)}. ` +
        `Illuminant: relative power, ${peak(illuminant)}.`,
    )
  }

  /**
   * Swatches of the colours that spectra give, beside those that are rendered.
   *
   * @param rendered - null while the picture moves
   */
  compare(
    flash: Radiance,
    environment: Radiance | null,
    rendered: RenderedColour | null,
    exposure: number,
  ): void {
    if (!this.block.isOpen) return
    const computed = {
      flash: flash.colour,
      all: flash.colour.map((value, c) => value + (environment?.colour[c] ?? 0)) as Colour,
    }
    this.#swatches.replaceChildren(
      swatch('Flash, by its spectrum', computed.flash, exposure),
      swatch('Flash, as rendered', rendered?.flash ?? null, exposure),
      swatch('Flash and environment', computed.all, exposure),
      swatch('Pixel as rendered', rendered?.all ?? null, exposure),
    )
  }
}

const KEYS = { flash: 'Flash', environment: 'Environment', illuminant: 'Illuminant' }

function values({ factors }: Radiance, illuminant: Float64Array): number[] {
  return Array.from(factors, (factor, cell) => factor * illuminant[cell]!)
}

function swatch(label: string, colour: Colour | null, exposure: number): HTMLElement {
  const patch = make('span', 'patch')
  const text = make('span', '', label)
  if (colour === null) return make('div', 'swatch waiting', patch, text, make('output', '', '…'))
  patch.style.backgroundColor = css(toneMapped(colour, exposure))
  const value = colour.map((channel) => number(channel, 2)).join(', ')
  const element = make('div', 'swatch', patch, text, make('output', '', value))
  element.dataset['rgb'] = colour.join(' ')
  return element
}

/** The colours of the wavelengths along the axis. */
function spectrumBar(chart: Chart, colours: readonly Colour[], y: ChartAxis): SVGElement[] {
  const step = 4
  const base = chart.y(0, y)
  return colours
    .filter((_, cell) => cell % step === 0)
    .map((colour, i) => {
      const from = chart.x(380 + i * step, WAVELENGTH_AXIS)
      const to = Math.min(
        chart.x(380 + (i + 1) * step, WAVELENGTH_AXIS),
        chart.x(780, WAVELENGTH_AXIS),
      )
      return svg('rect', {
        x: from,
        y: base,
        width: Math.max(to - from, 0) + 0.3,
        height: 4,
        fill: css(colour),
      })
    })
}
