import { fileURLToPath } from 'node:url'
import CopyPlugin from 'copy-webpack-plugin'
import webpack from 'webpack'

const maps = fileURLToPath(new URL('.', import.meta.resolve('three-diffraction/maps/metals.json')))
const compiler = webpack({
  mode: 'production',
  entry: './main.js',
  experiments: { outputModule: true },
  output: { module: true, filename: '[name].js', clean: true },
  // Minified by Vite and esbuild; webpack's minifier needs half a minute for three.
  optimization: { minimize: false },
  performance: { hints: false },
  plugins: [
    new CopyPlugin({
      patterns: [
        { from: maps, to: 'maps/baked' },
        { from: 'index.html', to: 'index.html' },
      ],
    }),
  ],
})
compiler.run((error, stats) => {
  if (error) throw error
  if (stats?.hasErrors() || stats?.hasWarnings()) {
    console.error(stats.toString('errors-warnings'))
    process.exitCode = 1
  }
  compiler.close(() => undefined)
})
