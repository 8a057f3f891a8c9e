// Renders scene files in Chromium and writes what came out as float32.
//
//   node tests/browser/render.mjs [--backend llvmpipe|swiftshader] --output FOLDER SCENE.json …
//
// For each scene NAME.json in FOLDER: NAME.radiance.f32 (rows from the top, RGBA), NAME.geometry.f32 (layers position,
// normal, tangent, grating, uv), NAME.environment.f32 where there is one, NAME.frag, the fragment shader as WebGL compiled
// it, and NAME.json with sizes, camera, lights and the tables that the shader reads. Prints NAME once they are there.
import { mkdir, readFile, writeFile } from 'node:fs/promises'
import { basename, join } from 'node:path'
import { parseArgs } from 'node:util'
import { openHarness } from './open-harness.mjs'

const { values, positionals } = parseArgs({
  options: {
    backend: { type: 'string', default: 'llvmpipe' },
    output: { type: 'string' },
  },
  allowPositionals: true,
})
const { backend, output } = values
if (
  output === undefined ||
  positionals.length === 0 ||
  !(backend === 'llvmpipe' || backend === 'swiftshader')
) {
  console.error(
    'Usage: node tests/browser/render.mjs [--backend llvmpipe|swiftshader] --output FOLDER SCENE.json …',
  )
  process.exit(2)
}

await mkdir(output, { recursive: true })
const harness = await openHarness({ backend })
try {
  for (const file of positionals) {
    const name = basename(file, '.json')
    const scene = JSON.parse(await readFile(file, 'utf8'))
    const { radiance, geometry, environment, fragmentShader, ...rest } =
      await harness.renderScene(scene)
    const path = (/** @type {string} */ suffix) => join(output, `${name}.${suffix}`)
    await writeFile(path('radiance.f32'), Buffer.from(radiance, 'base64'))
    await writeFile(path('geometry.f32'), Buffer.from(geometry, 'base64'))
    if (environment)
      await writeFile(path('environment.f32'), Buffer.from(environment.data, 'base64'))
    await writeFile(path('frag'), fragmentShader)
    const sizes = environment && { width: environment.width, height: environment.height }
    await writeFile(
      path('json'),
      JSON.stringify({ ...rest, environment: sizes, backend: harness.backend, scene }, null, 1),
    )
    console.log(name)
  }
} finally {
  await harness.close()
}
