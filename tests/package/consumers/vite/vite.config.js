import { cpSync } from 'node:fs'
import { fileURLToPath } from 'node:url'
import { defineConfig } from 'vite'

// Vite serves what is in public/ as it is, under the names that a map's sidecar gives its files.
const maps = fileURLToPath(new URL('.', import.meta.resolve('three-diffraction/maps/metals.json')))
cpSync(maps, 'public/maps/baked', { recursive: true })

export default defineConfig({ base: './', build: { target: 'es2022' } })
