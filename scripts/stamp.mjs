import { createHash } from 'node:crypto'
import {
  existsSync,
  mkdirSync,
  readdirSync,
  readFileSync,
  renameSync,
  rmSync,
  statSync,
  writeFileSync,
} from 'node:fs'
import { join } from 'node:path'

import { root } from './process.mjs'

/**
 * Every file under a file or folder of the repository, sorted; compiled Python is left out.
 *
 * @param {string} path relative to the repository, with forward slashes
 * @returns {string[]}
 */
export function filesUnder(path) {
  const absolute = join(root, path)
  if (!existsSync(absolute)) return []
  if (!statSync(absolute).isDirectory()) return [path]
  return readdirSync(absolute)
    .filter((name) => name !== '__pycache__')
    .sort()
    .flatMap((name) => filesUnder(`${path}/${name}`))
}

/**
 * SHA-256 over names and contents.
 *
 * @param {string[]} files relative to the repository
 * @param {string[]} facts further strings that the result depends on
 */
export function contentHash(files, facts = []) {
  const hash = createHash('sha256').update(JSON.stringify(facts))
  for (const file of files) {
    const content = readFileSync(join(root, file))
    hash.update(JSON.stringify([file, content.length])).update(content)
  }
  return hash.digest('hex')
}

/**
 * What tells at a glance whether files are still those that were made.
 *
 * @param {string[]} files relative to the repository
 */
function fingerprint(files) {
  return files.map((file) => {
    const status = statSync(join(root, file), { throwIfNoEntry: false })
    return status ? `${file} ${status.size} ${status.mtimeMs}` : `${file} missing`
  })
}

/**
 * Builds something unless the stamp of an earlier build says that neither what it was made from nor what it
 * made has changed. There is no stamp while a build is under way, so an interrupted one is done again.
 *
 * @param {string} name of the stamp
 * @param {string} inputs hash of all that the result depends on
 * @param {() => string[]} outputs files that stand for the result, relative to the repository
 * @param {() => Promise<void>} build
 */
export async function buildWhenStale(name, inputs, outputs, build) {
  const stamp = join(root, '.cache', `${name}.json`)
  const current = () => JSON.stringify({ inputs, outputs: fingerprint(outputs()) }, null, 1)
  if (existsSync(stamp) && readFileSync(stamp, 'utf8') === current()) return
  rmSync(stamp, { force: true })
  await build()
  mkdirSync(join(root, '.cache'), { recursive: true })
  writeFileSync(`${stamp}.new`, current())
  renameSync(`${stamp}.new`, stamp)
}
