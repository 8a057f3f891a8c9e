import { CanvasTexture, SRGBColorSpace } from 'three'

/** Pixels of the print; its shape is the note's. */
const [WIDTH, HEIGHT] = [2048, 932]
const INK = '#1d4a52'
const SOFT_INK = '#7d9c8f'
const PAPER = '#d9d6c3'

/** What is printed on a note that no bank has issued: guilloches, as engraving machines draw them, and its value. */
export function notePrint(): CanvasTexture {
  const canvas = document.createElement('canvas')
  canvas.width = WIDTH
  canvas.height = HEIGHT
  const context = canvas.getContext('2d')
  if (context !== null) print(context)
  const texture = new CanvasTexture(canvas)
  texture.colorSpace = SRGBColorSpace
  texture.anisotropy = 8
  return texture
}

function print(context: CanvasRenderingContext2D): void {
  context.fillStyle = PAPER
  context.fillRect(0, 0, WIDTH, HEIGHT)
  context.strokeStyle = SOFT_INK
  context.lineWidth = 1.2
  for (let line = 0; line < 44; line++) wave(context, line / 44)
  context.lineWidth = 1.6
  context.strokeStyle = INK
  for (let turn = 0; turn < 5; turn++) rosette(context, 520, HEIGHT / 2, 300 - 40 * turn, turn)
  context.strokeRect(36, 36, WIDTH - 72, HEIGHT - 72)
  context.strokeRect(48, 48, WIDTH - 96, HEIGHT - 96)

  context.fillStyle = INK
  context.font = '700 190px Georgia, "Times New Roman", serif'
  context.textAlign = 'left'
  context.fillText('532', 920, 330)
  context.font = '600 44px Georgia, "Times New Roman", serif'
  context.fillText('NANOMETRES', 930, 410)
  context.font = '28px Georgia, "Times New Roman", serif'
  context.fillText('of green light, payable to the bearer', 930, 470)
  context.font = '26px ui-monospace, monospace'
  context.fillText('TD 0660 1550 1064', 930, HEIGHT - 110)
}

/** One of many lines that run from side to side, each a little further on in phase. */
function wave(context: CanvasRenderingContext2D, share: number): void {
  context.beginPath()
  for (let x = 0; x <= WIDTH; x += 6) {
    const phase = (2 * Math.PI * x) / WIDTH
    const swing = 70 * Math.sin(3 * phase + 5 * share) + 40 * Math.sin(7 * phase - 9 * share)
    context.lineTo(x, share * (HEIGHT + 240) - 120 + swing)
  }
  context.stroke()
}

/** A closed line about a middle, whose radius beats with two frequencies. */
function rosette(
  context: CanvasRenderingContext2D,
  x: number,
  y: number,
  radius: number,
  turn: number,
): void {
  const steps = 2400
  context.beginPath()
  for (let step = 0; step <= steps; step++) {
    const angle = (2 * Math.PI * step) / steps
    const r = radius * (0.78 + 0.2 * Math.sin(24 * angle + turn) * Math.cos(5 * angle))
    context.lineTo(x + r * Math.cos(angle), y + r * Math.sin(angle))
  }
  context.stroke()
}
