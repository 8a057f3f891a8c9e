import { fileURLToPath } from 'node:url'
import { defineConfig, normalizePath, type Plugin } from 'vite'
import { completePage, demoPage } from './scripts/demo-page.mjs'
import { minifiedGlsl } from './scripts/minified-glsl.mjs'

const repository = normalizePath(fileURLToPath(new URL('.', import.meta.url)))

/** Serves maps/baked/, which lies above the page's root, at /maps/baked/. */
function bakedMaps(): Plugin {
  return {
    name: 'baked-maps',
    configureServer(server) {
      server.middlewares.use((request, _response, next) => {
        if (request.url?.startsWith('/maps/baked/')) {
          request.url = `/@fs/${repository}`.replace('//', '/') + request.url.slice(1)
        }
        next()
      })
    },
  }
}

/** The demo page; the browser tests serve their own pages with it, by another root. */
export default defineConfig({
  root: fileURLToPath(new URL('demo', import.meta.url)),
  // Not 'spa': a map that is missing must be a 404, not the page itself.
  appType: 'mpa',
  // three and its add-ons are ES modules already. Bundling them on the way would reload a page in mid-test
  // when a further one is discovered, and could put a second three beside the first.
  optimizeDeps: { noDiscovery: true, include: [] },
  server: {
    host: '127.0.0.1',
    fs: {
      allow: ['demo', 'maps', 'node_modules', 'shaders', 'tests', 'web'].map(
        (folder) => repository + folder,
      ),
    },
  },
  preview: { host: '127.0.0.1' },
  plugins: [bakedMaps(), minifiedGlsl(), completePage()],
  build: {
    outDir: repository + demoPage,
    emptyOutDir: true,
    target: 'es2022',
    // The policy of the built page lets no script or style stand in it, nor be fetched from `data:`.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    rolldownOptions: {
      input: [
        fileURLToPath(new URL('demo/index.html', import.meta.url)),
        fileURLToPath(new URL('demo/offline/service-worker.ts', import.meta.url)),
      ],
      output: {
        // A worker rules over what lies beside and below it, and is looked for by its name.
        entryFileNames: ({ name }) =>
          name === 'service-worker' ? '[name].js' : 'assets/[name]-[hash].js',
      },
    },
  },
})
