import { fileURLToPath } from 'node:url'
import { defineConfig, normalizePath, type Plugin } from 'vite'

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
  plugins: [bakedMaps()],
})
