/** Writes pinned.html: index.html with an import map that pins every module of three and of the package. */
import { createHash } from 'node:crypto'
import { readdirSync, readFileSync, writeFileSync } from 'node:fs'
import { fileURLToPath } from 'node:url'

/** Folders of modules, as Node finds them and as the page does. */
const folders = {
  [import.meta.resolve('three')]: '/node_modules/three/build/',
  [import.meta.resolve('three/addons/postprocessing/Pass.js')]:
    '/node_modules/three/examples/jsm/postprocessing/',
  [import.meta.resolve('three-diffraction')]: '/node_modules/three-diffraction/dist/',
}
/** @type {Record<string, string>} */
const integrity = {}
for (const [module, address] of Object.entries(folders)) {
  const folder = fileURLToPath(new URL('.', module))
  for (const file of readdirSync(folder, { recursive: true, encoding: 'utf8' })) {
    if (!file.endsWith('.js')) continue
    const sum = createHash('sha384')
      .update(readFileSync(folder + file))
      .digest('base64')
    integrity[address + file.replaceAll('\\', '/')] = `sha384-${sum}`
  }
}
const html = readFileSync('index.html', 'utf8').replace(
  /(<script type="importmap">)([^]*?)(<\/script>)/,
  (_, open, map, close) =>
    open + JSON.stringify({ ...JSON.parse(map), integrity }, null, 2) + close,
)
writeFileSync('pinned.html', html)
