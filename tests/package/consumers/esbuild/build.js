import { cpSync } from 'node:fs'
import { fileURLToPath } from 'node:url'
import { build } from 'esbuild'

await build({
  entryPoints: ['main.js'],
  bundle: true,
  minify: true,
  format: 'esm',
  // Code that is fetched when it is needed stays in files of its own.
  splitting: true,
  target: 'es2022',
  outdir: 'dist',
})
const maps = fileURLToPath(new URL('.', import.meta.resolve('three-diffraction/maps/metals.json')))
cpSync(maps, 'dist/maps/baked', { recursive: true })
cpSync('index.html', 'dist/index.html')
