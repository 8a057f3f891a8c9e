import { execFile } from 'node:child_process'
import { fileURLToPath } from 'node:url'
import { promisify } from 'node:util'
import { venvProgram } from '../../scripts/python.mjs'

const root = fileURLToPath(new URL('../../', import.meta.url))

/**
 * What a Python program prints as JSON, run by the repository's own environment in its root.
 *
 * @param input - its `input`, through JSON
 */
export async function python(program: string, input: unknown = null): Promise<unknown> {
  const { stdout } = await promisify(execFile)(
    fileURLToPath(new URL(`../../${venvProgram('python')}`, import.meta.url)),
    ['-c', `import json, sys\ninput = json.loads(sys.argv[1])\n${program}`, JSON.stringify(input)],
    { cwd: root, maxBuffer: 2 ** 28 },
  )
  return JSON.parse(stdout) as unknown
}
