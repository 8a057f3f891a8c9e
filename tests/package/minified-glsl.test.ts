import { readdirSync, readFileSync } from 'node:fs'
import { describe, expect, it } from 'vitest'
import { minifyGlsl } from '../../scripts/minified-glsl.mjs'
import { glslTokens } from './glsl-tokens'

const shaders = new URL('../../shaders/', import.meta.url)

describe('tokens', () => {
  it.each([
    ['a - -b', 'a--b'],
    ['int a', 'inta'],
    ['a + +b', 'a ++ b'],
    ['#define F (x)', '#define F(x)'],
    ['#endif\nx', '#endif x'],
    ['1.0 .x', '1.0.x'],
    ['a < = b', 'a <= b'],
    ['a / b', 'a // b'],
  ])('tell %j from %j', (one, other) => {
    expect(glslTokens(one)).not.toEqual(glslTokens(other))
  })

  it('know numbers, operators, directives and comments', () => {
    expect(glslTokens('x+=1.5e-3-.5f; // sum\n#if A /* a\nb */ > 2 // c\ny')).toEqual([
      'x',
      '+=',
      '1.5e-3',
      '-',
      '.5f',
      ';',
      '#',
      'if',
      'A',
      '>',
      '2',
      'end of line',
      'y',
    ])
  })
})

describe('minified', () => {
  it.each([
    ['float a = b * ( c - -d );  // why', 'float a=b*(c- -d);'],
    ['\n\n\tif (a <= 0.0)\n\t\treturn -a;\n', 'if(a<=0.0)\nreturn-a;'],
    ['a /* one\n two */ b', 'a b'],
    ['a + ++b', 'a+ ++b'],
    ['return .5 ;', 'return .5;'],
    ['\t#define F  (x)   // macro\n  y', '#define F (x)\ny'],
    ['#endif // NAME', '#endif'],
    ['  #include <common>  ', '#include <common>'],
    ['#include "a.glsl"  // why', '#include "a.glsl"'],
    ['#define A \\\n\t1\nb', '#define A 1\nb'],
    ['a\r\nb', 'a\nb'],
  ])('%j is %j', (source, minified) => {
    expect(minifyGlsl(source)).toBe(minified)
  })
})

const files = readdirSync(shaders, { recursive: true, encoding: 'utf8' }).filter((file) =>
  file.endsWith('.glsl'),
)

it.each(files)('%s keeps its tokens and its included lines', (file) => {
  const source = readFileSync(new URL(file.replaceAll('\\', '/'), shaders), 'utf8')
  const minified = minifyGlsl(source)
  expect(minified.length).toBeLessThan(source.length)
  expect(glslTokens(minified)).toEqual(glslTokens(source))
  // three finds its chunks, and the package its files, by lines that hold nothing else.
  const includes = (text: string): string[] => text.match(/^[ \t]*#include.*$/gm) ?? []
  expect(includes(minified)).toEqual(includes(source).map((line) => line.trim()))
})
