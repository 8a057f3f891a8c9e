import { MathUtils } from 'three'

/** A number to so many significant digits, with a true minus sign. */
export function number(value: number, digits = 3): string {
  if (value === 0) return '0'
  const size = Math.abs(value)
  const text =
    size < 1e-3 || size >= 1e5 ? value.toExponential(digits - 1) : value.toPrecision(digits)
  return text.replaceAll('-', '−')
}

export function degrees(radians: number, decimals = 1): string {
  return `${MathUtils.radToDeg(radians).toFixed(decimals).replace('-', '−')}°`
}

export function percent(share: number): string {
  const value = 100 * share
  return `${value > 0 && value < 0.1 ? value.toPrecision(1) : value.toFixed(1)}\u202f%`
}

export function micrometres(length: number, digits = 3): string {
  return `${number(length, digits)}\u202fµm`
}

export function nanometres(micrometres: number): string {
  return `${Math.round(1000 * micrometres)}\u202fnm`
}

/** An order as it is written, +1 or −1. */
export function signed(order: number): string {
  return order > 0 ? `+${order}` : String(order).replace('-', '−')
}
