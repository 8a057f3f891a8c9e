/** What is strewn. */
export interface Figure {
  /** Whether (x to the right, y up) lies on it, within its box of ±½. */
  isOn: (x: number, y: number) => boolean
  /** Share of its box that it covers, to a thousandth. */
  area: number
}

export function square(): Figure {
  return { isOn: () => true, area: 1 }
}

/** As wide as its box. */
export function disc(): Figure {
  const isOn = (x: number, y: number): boolean => x ** 2 + y ** 2 <= 0.25
  return { isOn, area: areaOf(isOn) }
}

/** Counted at places in the box. */
export function areaOf(isOn: Figure['isOn']): number {
  const samples = 512
  let count = 0
  for (let row = 0; row < samples; row++)
    for (let column = 0; column < samples; column++)
      if (isOn((column + 0.5) / samples - 0.5, (row + 0.5) / samples - 0.5)) count++
  return count / samples ** 2
}
