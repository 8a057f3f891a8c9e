/** What the commands need before they can start; each does nothing where everything is in place. */
export { ensureDemoPage } from './demo-page.mjs'
export { ensureBrowser, findBrowser } from './find-browser.mjs'
export { ensureMaps } from './maps.mjs'
export { ensureNodePackages } from './node-packages.mjs'
export { ensurePython } from './python.mjs'
