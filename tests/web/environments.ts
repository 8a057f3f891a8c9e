import { readFile, writeFile } from 'node:fs/promises'
import { tmpdir } from 'node:os'
import { join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { DataTexture, DataUtils } from 'three'
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js'

const root = new URL('../../node_modules/@pmndrs/assets/hdri/', import.meta.url)

/** An environment of @pmndrs/assets, as the page loads it. */
export async function loadedEnvironment(name: string): Promise<DataTexture> {
  const module = await readFile(fileURLToPath(new URL(`${name}.exr.js`, root)), 'utf8')
  const bytes = Buffer.from(/base64,([^'"]*)/.exec(module)![1]!, 'base64')
  const { data, width, height } = new EXRLoader().parse(Uint8Array.from(bytes).buffer)
  return new DataTexture(data, width, height)
}

/** An environment that is given by direction, linear sRGB. */
export function madeEnvironment(
  width: number,
  radiance: (x: number, y: number, z: number) => [number, number, number],
): DataTexture {
  const height = width / 2
  const data = new Uint16Array(4 * width * height)
  for (let row = 0; row < height; row++)
    for (let column = 0; column < width; column++) {
      const rise = ((row + 0.5) / height - 0.5) * Math.PI
      const azimuth = ((column + 0.5) / width - 0.5) * 2 * Math.PI
      const flat = Math.cos(rise)
      const rgb = radiance(flat * Math.cos(azimuth), Math.sin(rise), flat * Math.sin(azimuth))
      data.set(
        [...rgb, 1].map((value) => DataUtils.toHalfFloat(value)),
        4 * (row * width + column),
      )
    }
  return new DataTexture(data, width, height)
}

/** Writes an environment's texels for Python: float32, rows from the bottom, four channels. */
export async function texelFile({ image }: DataTexture, name: string): Promise<string> {
  const halves = image.data as unknown as Uint16Array
  const file = join(tmpdir(), `${name}-${process.pid}.f32`)
  await writeFile(
    file,
    Float32Array.from(halves, (half) => DataUtils.fromHalfFloat(half)),
  )
  return file
}
