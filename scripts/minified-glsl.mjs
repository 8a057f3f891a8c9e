import { readFile } from 'node:fs/promises'

const SHADER = /\.glsl\?raw$/

/** Joined lines, then comments, as the preprocessor takes them out. */
const JOINED = /\\\r?\n/g
const COMMENT = /\/\/.*|\/\*[^]*?\*\//g

/** What would become one token, or the start of a comment, if nothing stood between: `a b`, `a - -b`. */
const FUSES = /^(?:[\w.]{2}|[-+*/%<>=!&|^]{2})$/

/**
 * GLSL without comments and without the whitespace that separates nothing: the same tokens in the same order. Lines stay
 * lines, since a directive and three's `#include <…>` each need their own, and a compiler's message names one.
 *
 * @param {string} source
 */
export function minifyGlsl(source) {
  return source
    .replace(JOINED, '')
    .replace(COMMENT, ' ')
    .split('\n')
    .map((line) => squeeze(line.trim().replace(/\s+/g, ' ')))
    .filter((line) => line !== '')
    .join('\n')
}

/** @param {string} line */
function squeeze(line) {
  // `#define F (x)` and `#define F(x)` are two things.
  if (line.startsWith('#')) return line
  return line.replace(/ /g, (space, at) =>
    FUSES.test(line.charAt(at - 1) + line.charAt(at + 1)) ? space : '',
  )
}

/**
 * Has the npm package's shaders minified.
 *
 * @returns {import('vite').Plugin}
 */
export function minifiedGlsl() {
  return {
    name: 'minified-glsl',
    enforce: 'pre',
    load: {
      filter: { id: SHADER },
      async handler(id) {
        const source = await readFile(id.replace(/\?raw$/, ''), 'utf8')
        const code = `export default ${JSON.stringify(minifyGlsl(source))}`
        return { code, map: { mappings: '' } }
      },
    },
  }
}
