import { cleanupOutdatedCaches, precacheAndRoute, type PrecacheEntry } from 'workbox-precaching'

/** The build writes every file of the page in here, with its hash: vite.config.ts. */
declare const __PRECACHED__: PrecacheEntry[]

// All of the page, its maps and environments are kept: a gallery of which parts are missing would be none.
precacheAndRoute(__PRECACHED__, {
  // `?scene=disc` is the same page.
  ignoreURLParametersMatching: [/.*/],
})
cleanupOutdatedCaches()
