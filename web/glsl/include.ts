import { refuse } from '../errors.ts'

const INCLUDE = /^[ \t]*#include "([^"]*)"[ \t]*$/gm

/**
 * Resolves `#include "name.glsl"` in a shader from a table of files by name. Each file is taken in once, where
 * it is first asked for. three's own `#include <chunk>` is left to three.
 */
export function resolveIncludes(source: string, files: Record<string, string>): string {
  const included = new Set<string>()
  const resolve = (text: string, within: string): string =>
    text.replace(INCLUDE, (_line, name: string) => {
      const file = files[name]
      if (file === undefined)
        refuse(within, '#include', name, `one of ${Object.keys(files).join(', ')}`)
      if (included.has(name)) return ''
      included.add(name)
      return resolve(file, name)
    })
  return resolve(source, 'shader')
}
