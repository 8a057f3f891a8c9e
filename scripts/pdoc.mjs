import { join } from 'node:path'

import { root } from './process.mjs'
import { venvProgram } from './python.mjs'

/**
 * The program that documents precompute, and its arguments.
 *
 * @param {string} folder where the pages go
 * @returns {[string, ...string[]]}
 */
export function pdocCommand(folder) {
  return [
    join(root, venvProgram('pdoc')),
    ...['--docformat', 'google', '--no-show-source'],
    ...['--output-directory', folder],
    'precompute',
    // What the command line is and the report's drawings are no interface.
    '!precompute.cli',
    '!precompute.report',
  ]
}
