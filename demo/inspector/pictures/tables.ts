import { METALS } from '../../../web/surfaces/surface'
import { parameterFromTexel } from '../../../web/maps/axes'
import { arrayOf, valuesOf, type LoadedMap, type MapArray } from '../../../web/maps/load'
import { make } from '../../ui/elements'
import { toneMapped } from '../optics/display'
import type { Colour, LightSpectrum } from '../optics/light-spectrum'
import type { SpectralTables } from '../point-optics'
import { Block } from './block'
import { Chart, WAVELENGTH_AXIS, type ChartAxis } from './chart'
import { number } from './numbers'
import { svg } from './svg'

/** The baked tables that the material reads, as they are stored. */
export class TablePictures {
  readonly blocks: readonly Block[]
  readonly #efficiency = new TablePicture('Table: profile efficiency', 190)
  readonly #coefficients = new TablePicture('Table: series of the relief', 190)
  readonly #lobes = new TablePicture('Table: colours of lobes', 170)
  readonly #metals = new Chart(180)
  readonly #metalBlock: Block
  #shown: SpectralTables | null = null

  constructor() {
    const key = make('p', 'key', ...METALS.map((name) => make('span', `key-${name}`, name)))
    this.#metalBlock = new Block('Table: metals', false, this.#metals.element, key)
    this.blocks = [
      this.#efficiency.block,
      this.#coefficients.block,
      this.#lobes.block,
      this.#metalBlock,
    ]
    for (const { element } of this.blocks)
      element.addEventListener('toggle', () => {
        if (element.open && this.#shown !== null) this.#draw(this.#shown)
      })
  }

  show(tables: SpectralTables): void {
    if (this.#shown === tables) return
    this.#shown = tables
    this.#draw(tables)
  }

  #draw({ maps, spectrum }: SpectralTables): void {
    const { profile, relief, lobes, metals } = maps
    this.#efficiency.block.element.hidden = profile === null
    this.#coefficients.block.element.hidden = relief === null
    if (profile !== null && this.#efficiency.block.isOpen) drawEfficiency(this.#efficiency, profile)
    if (relief !== null && this.#coefficients.block.isOpen) drawSeries(this.#coefficients, relief)
    if (this.#lobes.block.isOpen) drawLobes(this.#lobes, lobes, spectrum)
    if (this.#metalBlock.isOpen) this.#drawMetals(metals)
  }

  #drawMetals(metals: LoadedMap): void {
    const array = arrayOf(metals, 'reflectance')
    const axis = array.spec.axes[1]!
    const values = valuesOf(array)
    const y: ChartAxis = {
      ...{ from: 0, to: 1, ticks: [0, 0.25, 0.5, 0.75, 1] },
      ...{ label: 'reflectance R', write: (value: number) => String(value) },
    }
    const at = (texel: number, metal: number): [number, number] => [
      1000 / parameterFromTexel(axis, texel),
      values[texel * METALS.length + metal]!,
    ]
    this.#metals.draw(
      WAVELENGTH_AXIS,
      y,
      ...METALS.map((name, metal) =>
        this.#metals.curve(
          WAVELENGTH_AXIS,
          y,
          Array.from({ length: axis.size }, (_, texel) => at(texel, metal)),
          name,
        ),
      ),
    )
    const ends = METALS.map((name, metal) => {
      return `${name} ${number(at(axis.size - 1, metal)[1], 2)} at 380 nm, ${number(at(0, metal)[1], 2)} at 780 nm`
    })
    this.#metalBlock.describe(
      `Reflectance of metals in air at normal incidence: ${ends.join('; ')}. ${axis.size} texels over wavenumber 1/λ.`,
    )
  }
}

/** Paints a texel's colour, 0 to 255. */
type Paint = (column: number, row: number) => Colour

/** A table as a picture of its texels within axes. */
class TablePicture {
  readonly block: Block
  readonly chart: Chart
  readonly #canvas = make('canvas', '')

  constructor(title: string, height: number) {
    this.chart = new Chart(height)
    this.block = new Block(title, false, this.chart.element)
  }

  /** Columns along x from the left, rows along y from below. */
  draw(x: ChartAxis, y: ChartAxis, columns: number, rows: number, paint: Paint): void {
    Object.assign(this.#canvas, { width: columns, height: rows })
    const context = this.#canvas.getContext('2d')!
    const pixels = context.createImageData(columns, rows)
    for (let row = 0; row < rows; row++)
      for (let column = 0; column < columns; column++)
        pixels.data.set([...paint(column, row), 255], 4 * ((rows - 1 - row) * columns + column))
    context.putImageData(pixels, 0, 0)
    const [left, right] = [this.chart.x(x.from, x), this.chart.x(x.to, x)]
    const [top, bottom] = [this.chart.y(y.to, y), this.chart.y(y.from, y)]
    this.chart.draw(
      x,
      y,
      svg('image', {
        ...{ x: left, y: top, width: right - left, height: bottom - top },
        ...{ href: this.#canvas.toDataURL(), preserveAspectRatio: 'none', class: 'texels' },
      }),
    )
  }
}

function drawEfficiency(picture: TablePicture, profile: LoadedMap): void {
  const array = arrayOf(profile, 'efficiency')
  const values = valuesOf(array)
  const [orders, phases] = array.spec.axes as [
    MapArray['spec']['axes'][0],
    MapArray['spec']['axes'][0],
  ]
  const most = 8
  const rows = 2 * most + 1
  const first = -most - orders.first
  const x: ChartAxis = {
    ...{ from: 0, to: Math.sqrt(phases.last), label: 'phase depth φ = 2π w h0/λ, rad' },
    ticks: [0, 1, 4, 9, 16, 25].filter((φ) => φ <= phases.last).map(Math.sqrt),
    write: (root) => String(Math.round(root ** 2)),
  }
  const y: ChartAxis = {
    ...{ from: -most - 0.5, to: most + 0.5, ticks: [-8, -4, 0, 4, 8] },
    ...{ label: 'order m', write: (m: number) => String(m).replace('-', '−') },
  }
  picture.draw(x, y, phases.size, rows, (column, row) => {
    const share = values[(row + first) * phases.size + column]!
    const level = 255 * Math.cbrt(Math.min(Math.max(share, 0), 1))
    return [level, level, level]
  })
  const at = (m: number, φ: number): string =>
    number(
      values[
        (m - orders.first) * phases.size +
          Math.round(Math.sqrt(φ / phases.last) * (phases.size - 1))
      ]!,
      2,
    )
  picture.block.describe(
    `Share η of the light that order m takes over phase depth, ${orders.size} orders (±8 shown) × ${phases.size} phases to ${number(phases.last)} rad; brightness goes with its cube root. ` +
      `At φ = 2 rad: order 0 ${at(0, 2)}, +1 ${at(1, 2)}, −1 ${at(-1, 2)}, +2 ${at(2, 2)}.`,
  )
}

function drawLobes(picture: TablePicture, lobes: LoadedMap, spectrum: LightSpectrum): void {
  const array = arrayOf(lobes, 'lobe')
  const [, widths, positions] = array.spec.axes
  const [columns, rows] = [positions!.size, widths!.size]
  // Only white's layer; the others are for tinted light.
  const values = valuesOf({ spec: array.spec, data: array.data.subarray(0, 4 * columns * rows) })
  let brightest = 0
  for (let i = 1; i < values.length; i += 4) brightest = Math.max(brightest, values[i]!)
  const logs = [Math.log10(widths!.first), Math.log10(widths!.last)] as const
  const x: ChartAxis = {
    ...{ from: 0, to: 1, ticks: [0, 0.25, 0.5, 0.75, 1] },
    label: 'position x of s* in its range, from red to violet',
    write: String,
  }
  const y: ChartAxis = {
    ...{ from: logs[0], to: logs[1], label: 'width q, 1/µm' },
    ticks: [0.005, 0.01, 0.02, 0.05].map(Math.log10),
    write: (log) => number(10 ** log, 1),
  }
  picture.draw(x, y, columns, rows, (column, row) => {
    const at = 4 * (row * columns + column)
    const rgb = spectrum.rgb([values[at]!, values[at + 1]!, values[at + 2]!])
    return toneMapped(rgb.map((value) => value / brightest) as Colour, 0.8)
  })
  picture.block.describe(
    `Colour of a Gaussian lobe about wavenumber s* with deviation q under this illuminant, T(s*, q): ${columns} positions × ${rows} widths from ${number(widths!.first)} to ${number(widths!.last)} 1/µm, ` +
      `brightest Y = ${number(brightest)}; a fourth channel holds the mean wavenumber.`,
  )
}

function drawSeries(picture: TablePicture, relief: LoadedMap): void {
  const array = arrayOf(relief, 'coefficients')
  const [terms, samples] = array.spec.shape as [number, number]
  const arguments_ = array.spec.axes[1]!
  const values = valuesOf(array)
  const x: ChartAxis = {
    ...{
      from: arguments_.first,
      to: arguments_.last,
      label: 'argument x = 2π s w · amplitude, rad',
    },
    ticks: [0, 0.25, 0.5, 0.75, 1].map((t) => t * arguments_.last),
    write: (value) => number(value, 2),
  }
  const y: ChartAxis = {
    ...{ from: -0.5, to: terms - 0.5, label: 'term n', write: String },
    ticks: [0, terms >> 1, terms - 1],
  }
  picture.draw(x, y, samples, terms, (column, row) => {
    const value = values[row * samples + column]!
    const level = 255 * Math.sqrt(Math.min(Math.abs(value) / 2, 1))
    // Negative ones blue, so that signs are told by more than hue: they are darker.
    return value < 0 ? [0.35 * level, 0.55 * level, level] : [level, level, 0.8 * level]
  })
  picture.block.describe(
    `Coefficients c_n(x) of the series of exp(ikwh): ${terms} terms × ${samples} arguments to ${number(arguments_.last)} rad; pale: positive, blue: negative, black: 0. ` +
      `At x = 0 term 0 is ${number(values[0]!)}.`,
  )
}
