const OPERATORS = [
  ...['<<=', '>>='],
  ...['++', '--', '<<', '>>', '<=', '>=', '==', '!=', '&&', '||', '^^'],
  ...['+=', '-=', '*=', '/=', '%=', '&=', '|=', '^='],
]

const isSpace = (c: string): boolean => c !== '' && ' \t\r\n\v\f'.includes(c)
const isDigit = (c: string): boolean => c >= '0' && c <= '9'
const isWord = (c: string): boolean =>
  isDigit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c === '_'

/**
 * The preprocessing tokens of GLSL ES 3.00 (sections 3.2 to 3.9), read character by character. A directive opens with
 * '#', closes with 'end of line', and keeps apart `#define F(x)`, whose parenthesis opens parameters, and `#define F (x)`.
 */
export function glslTokens(source: string): string[] {
  const text = source.replaceAll('\r\n', '\n').replaceAll('\\\n', '')
  const tokens: string[] = []
  let isDirective = false
  let isLineStart = true
  let at = 0
  const takeWhile = (holds: (c: string, before: string) => boolean): string => {
    const start = at++
    while (at < text.length && holds(text[at]!, text[at - 1]!)) at++
    return text.slice(start, at)
  }
  while (at < text.length) {
    const c = text[at]!
    const next = text[at + 1] ?? ''
    if (c === '\n') {
      if (isDirective) tokens.push('end of line')
      isDirective = false
      isLineStart = true
      at++
    } else if (isSpace(c)) {
      at++
    } else if (c === '/' && next === '/') {
      takeWhile((character) => character !== '\n')
    } else if (c === '/' && next === '*') {
      at = text.indexOf('*/', at + 2) + 2
    } else {
      if (c === '#' && isLineStart) isDirective = true
      isLineStart = false
      if (isDigit(c) || (c === '.' && isDigit(next)))
        tokens.push(
          takeWhile((character, before) => {
            const isExponent = 'eE'.includes(before) && '+-'.includes(character)
            return isWord(character) || character === '.' || isExponent
          }),
        )
      else if (isWord(c)) {
        tokens.push(takeWhile(isWord))
        const isMacro = isDirective && tokens.at(-2) === 'define' && tokens.at(-3) === '#'
        if (isMacro && text[at] === '(') tokens.push('parameters')
      } else if (c === '"') {
        const end = text.indexOf('"', at + 1) + 1
        tokens.push(text.slice(at, end))
        at = end
      } else {
        const operator = OPERATORS.find((candidate) => text.startsWith(candidate, at)) ?? c
        tokens.push(operator)
        at += operator.length
      }
    }
  }
  if (isDirective) tokens.push('end of line')
  return tokens
}
