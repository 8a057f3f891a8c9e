const NAMESPACE = 'http://www.w3.org/2000/svg'

/** A new SVG element. Numbers are written to a hundredth of a unit. */
export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Record<string, string | number>,
  ...content: (Node | string)[]
): SVGElementTagNameMap[K] {
  const element = document.createElementNS(NAMESPACE, tag)
  for (const [name, value] of Object.entries(attributes))
    element.setAttribute(
      name,
      typeof value === 'number' ? String(Math.round(value * 100) / 100) : value,
    )
  element.append(...content)
  return element
}

/** A picture of that size in its own units, as wide as there is room. */
export function drawing(width: number, height: number): SVGSVGElement {
  return svg('svg', { viewBox: `0 0 ${width} ${height}`, class: 'plot' })
}
