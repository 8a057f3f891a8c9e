import { execFile } from 'node:child_process'
import { existsSync } from 'node:fs'
import { readdir, readFile, writeFile } from 'node:fs/promises'
import { dirname, join, relative, sep } from 'node:path'
import { fileURLToPath, pathToFileURL } from 'node:url'
import { promisify } from 'node:util'
import { gzipSync } from 'node:zlib'
import { checkPackage, createPackageFromTarballData } from '@arethetypeswrong/core'
import { publint } from 'publint'
import { formatMessage } from 'publint/utils'
import ts from 'typescript'
import { build, type Rolldown } from 'vite'
import { afterEach, beforeAll, describe, expect, it, vi } from 'vitest'
import * as source from '../../web/index'
import { glslTokens } from './glsl-tokens'
import { consumer, installed, root, tarball } from './pack'

/** What may be on the wire at most, bytes of gzip; three is not counted. */
const LIMITS = {
  /** DiffractionMaterial and Grating. */
  material: 25_000,
  /** What is fetched besides by materials that are rough, or have a `maxError`, by maps with images, and by height fields. */
  roughEnvironment: 6000,
  errorChoice: 2500,
  png: 1500,
  environmentSamples: 1000,
  /** What each further export adds. */
  Foil: 8000,
  HeightField: 8000,
  diffractionLayer: 2000,
  ProgressiveRefinement: 1500,
  /** Both plugins, to the material and its surfaces. */
  gltf: 7000,
  /** The maps that a material with a grating loads. */
  maps: 150_000,
}

/** What a package of three's kind needs, and nothing else. */
const SHIPPED =
  /^(package\.json|README\.md|LICENSE|dist\/.+\.(js|js\.map|d\.ts)|maps\/baked\/[^/]+\.(json|bin|png))$/

let files: string[]

const contentsOf = (file: string): Promise<string> => readFile(join(installed, file), 'utf8')
const gzipped = (data: string | Uint8Array): number => gzipSync(data, { level: 9 }).length

beforeAll(async () => {
  const entries = await readdir(installed, { recursive: true, withFileTypes: true })
  files = entries
    .filter((entry) => entry.isFile())
    .map((entry) => relative(installed, join(entry.parentPath, entry.name)).replaceAll(sep, '/'))
})

describe('the tarball', () => {
  it('holds what is needed and nothing else', () => {
    expect(files).toEqual(
      expect.arrayContaining([
        ...['LICENSE', 'README.md', 'dist/index.js', 'dist/index.d.ts'],
        ...['dist/gltf/index.js', 'dist/gltf/index.d.ts'],
      ]),
    )
    expect(files.filter((file) => !SHIPPED.test(file))).toEqual([])
  })

  it('has a source map with its sources for every module', async () => {
    for (const file of files.filter((name) => name.endsWith('.js'))) {
      const address = /\n\/\/# sourceMappingURL=(.+)\s*$/.exec(await contentsOf(file))?.[1]
      // A module of nothing but exports has nothing to map.
      if (address === undefined) expect(file).toMatch(/^dist\/(gltf\/)?index\.js$/)
      else {
        const map = JSON.parse(await contentsOf(join(dirname(file), address))) as {
          sources: string[]
          sourcesContent?: (string | null)[]
        }
        for (const [i, name] of map.sources.entries()) {
          const original = await readFile(join(root, dirname(file), name), 'utf8')
          expect(map.sourcesContent?.[i]).toBe(original)
        }
      }
    }
  })

  it('has every array of a baked map, and its sidecar, where `exports` says', async () => {
    const maps = files.filter((file) => file.startsWith('maps/'))
    const sidecars = maps.filter((file) => file.endsWith('.json'))
    const described = await Promise.all(
      sidecars.map(async (file) => {
        const { arrays } = JSON.parse(await contentsOf(file)) as {
          arrays: Record<string, { file: string }>
        }
        return Object.values(arrays).map((array) => `maps/baked/${array.file}`)
      }),
    )
    expect([...sidecars, ...described.flat()].sort()).toEqual(maps.sort())
    const printed = await runNode(
      `console.log(import.meta.resolve('three-diffraction/maps/metals.json'))`,
    )
    expect(existsSync(fileURLToPath(printed))).toBe(true)
  })

  it('passes publint', async () => {
    const { messages, pkg } = await publint({
      pack: { tarball: new Uint8Array(await readFile(tarball)).buffer },
      strict: true,
    })
    expect(messages.map((message) => formatMessage(message, pkg))).toEqual([])
  })

  it('passes are-the-types-wrong as a package of ES modules', async () => {
    const analysis = await checkPackage(createPackageFromTarballData(await readFile(tarball)))
    if (analysis.types === false) throw new Error('There are no declarations')
    // Its profile `esm-only` leaves out what came before `exports` and what asks by `require`.
    const ignored = ['node10', 'node16-cjs']
    const problems = analysis.problems.filter(
      (problem) => !('resolutionKind' in problem && ignored.includes(problem.resolutionKind)),
    )
    expect(problems).toEqual([])
  })

  it('has the shaders of the source, token by token', async () => {
    const shaders = files.filter((file) => /^dist\/shaders\/.*\.js$/.test(file))
    const sources = await readdir(join(root, 'shaders'), { recursive: true })
    expect(shaders).toHaveLength(sources.filter((file) => file.endsWith('.glsl')).length)
    for (const file of shaders) {
      const shipped = (await import(addressOf(file))) as { default: string }
      const name = file.replace(/^dist\/(.*)\.js$/, '$1.glsl')
      const text = await readFile(join(root, name), 'utf8')
      expect(glslTokens(shipped.default), name).toEqual(glslTokens(text))
    }
  })
})

it('is no larger than its limits', async () => {
  const { entry: material, later } = await bundleSizes('DiffractionMaterial, Grating')
  const sizeOf = async (names: string, plugins = ''): Promise<number> =>
    (await bundleSizes(names, plugins)).entry
  const added = async (name: string): Promise<number> =>
    (await sizeOf(`DiffractionMaterial, Grating, ${name}`)) - material
  const surfaces = 'DiffractionMaterial, Grating, Foil, HeightField'
  const plugins = 'GLTFDiffractionLoaderPlugin, GLTFDiffractionExporterPlugin'
  const sizes = {
    material,
    roughEnvironment: later['rough-environment'],
    errorChoice: later['error-choice'],
    png: later.png,
    environmentSamples: (await bundleSizes(surfaces)).later['environment-samples'],
    Foil: await added('Foil'),
    HeightField: await added('HeightField'),
    diffractionLayer: await added('diffractionLayer'),
    ProgressiveRefinement: await added('ProgressiveRefinement'),
    gltf: (await sizeOf(surfaces, plugins)) - (await sizeOf(surfaces)),
  }
  console.log('Bytes of gzip besides three:', sizes)
  for (const [name, size] of Object.entries(sizes))
    expect(size, name).toBeLessThanOrEqual(LIMITS[name as keyof typeof sizes])
})

describe('the built material', () => {
  afterEach(() => {
    vi.unstubAllGlobals()
  })

  it('loads its default maps from the package, within their limit', async () => {
    const loaded: Uint8Array<ArrayBuffer>[] = []
    vi.stubGlobal('fetch', async (address: string): Promise<Response> => {
      const data = new Uint8Array(await readFile(join(installed, address)))
      loaded.push(data)
      return new Response(data)
    })
    const built = (await import(addressOf('dist/index.js'))) as typeof source
    const material = new built.DiffractionMaterial({
      surface: new built.Grating({ period: 1.6, height: 0.12 }),
      mapsPath: 'maps/baked/',
    })
    await material.ready
    expect(material.defines).toHaveProperty('DIFFRACTION')
    const size = loaded.reduce((sum, data) => sum + gzipped(data), 0)
    console.log('Bytes of gzip of the default maps:', size)
    expect(loaded.length).toBeGreaterThan(3)
    expect(size).toBeLessThanOrEqual(LIMITS.maps)
  })

  it.each(['Grating', 'HeightField'] as const)(
    'has the shaders of the source on a %s',
    async (name) => {
      vi.stubGlobal('fetch', () => Promise.reject(new Error('There is no network')))
      const shadersOf = async (from: typeof source): Promise<string[][]> => {
        const surface =
          name === 'Grating'
            ? new from.Grating({ period: 1.6, height: 0.12 })
            : new from.HeightField({ field: 'fingers' })
        const material = new from.DiffractionMaterial({ surface, onError: () => undefined })
        await material.ready.catch(() => undefined)
        return [material.vertexShader, material.fragmentShader].map(glslTokens)
      }
      const built = (await import(addressOf('dist/index.js'))) as typeof source
      expect(await shadersOf(built)).toEqual(await shadersOf(source))
    },
  )
})

it('is imported where there is neither window nor WebGL', async () => {
  const printed = await runNode(`
    import { DiffractionMaterial, Grating } from 'three-diffraction'
    import { EXTENSION } from 'three-diffraction/gltf'
    const material = new DiffractionMaterial({
      surface: new Grating({ period: 1.6, height: 0.12 }),
      onError: () => {},
    })
    const error = await material.ready.catch((error) => error)
    console.log(typeof window, typeof document, material.isShaderMaterial, error.name, EXTENSION)
  `)
  expect(printed).toBe('undefined undefined true DiffractionError TDIFF_materials_diffraction')
})

describe.each([
  ['nodenext', ts.ModuleKind.NodeNext, ts.ModuleResolutionKind.NodeNext],
  ['bundler', ts.ModuleKind.ESNext, ts.ModuleResolutionKind.Bundler],
])('declarations under moduleResolution %s', (_name, module, moduleResolution) => {
  it('serve a strict program', async () => {
    const file = join(consumer, 'consumer.ts')
    await writeFile(
      file,
      `
        import { type Scene, Mesh, PlaneGeometry } from 'three'
        import { DiffractionMaterial, Foil, Grating, HeightField, type Feature } from 'three-diffraction'
        import { type DiffractionMaterialOptions, ProgressiveRefinement } from 'three-diffraction'
        import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js'
        import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js'
        import { GLTFDiffractionExporterPlugin, GLTFDiffractionLoaderPlugin } from 'three-diffraction/gltf'

        const options: DiffractionMaterialOptions = { surface: new Grating({ period: 1.6, height: 0.12 }) }
        export const material = new DiffractionMaterial({ ...options, metal: 'silver' })
        export const features: Feature[] = material.explain()
        export const foil: Promise<Foil> = Foil.load('maps/baked/foil-polygons')
        export const field = new HeightField({ field: 'fingers' })
        export const refinements = (...all: ConstructorParameters<typeof ProgressiveRefinement>) =>
          new ProgressiveRefinement(...all)
        export const loader = new GLTFLoader().register(
          (parser) => new GLTFDiffractionLoaderPlugin(parser, { mapsPath: 'maps/', rendering: false }),
        )
        export const exporter = new GLTFExporter().register(
          (writer) => new GLTFDiffractionExporterPlugin(writer, { uriOf: ({ url }) => url }),
        )
        // @ts-expect-error A path.
        export const plugin = new GLTFDiffractionLoaderPlugin(loader as never, { mapsPath: 1 })
        export const add = (scene: Scene): Scene => scene.add(new Mesh(new PlaneGeometry(), material))
        // @ts-expect-error A string: declarations that were not found would be 'any'.
        export const metal: number = material.metal
        // @ts-expect-error A period is needed.
        export const grating = new Grating({ height: 0.12 })
      `,
    )
    const program = ts.createProgram([file], {
      module,
      moduleResolution,
      target: ts.ScriptTarget.ES2022,
      lib: ['lib.es2022.d.ts', 'lib.dom.d.ts', 'lib.dom.iterable.d.ts'],
      types: [],
      strict: true,
      noEmit: true,
      skipLibCheck: false,
    })
    // three's own declarations are three's matter.
    const ours = program
      .getSourceFiles()
      .filter(({ fileName }) => relative(consumer, fileName).split(/[/\\]/)[0] !== '..')
    expect(ours.length).toBeGreaterThan(5)
    const problems = ours.flatMap((sourceFile) => [
      ...program.getSyntacticDiagnostics(sourceFile),
      ...program.getSemanticDiagnostics(sourceFile),
    ])
    const messages = problems.map((problem) =>
      ts.formatDiagnostic(problem, {
        getCanonicalFileName: (name) => name,
        getCurrentDirectory: () => consumer,
        getNewLine: () => '\n',
      }),
    )
    expect(messages).toEqual([])
  })
})

/** A file of the unpacked package, to be imported. */
function addressOf(file: string): string {
  return pathToFileURL(join(installed, file)).href
}

/** What a module of the consumer's prints. */
async function runNode(code: string): Promise<string> {
  const args = ['--input-type=module', '--eval', code]
  const { stdout } = await promisify(execFile)(process.execPath, args, { cwd: consumer })
  return stdout.trim()
}

/** Bytes of gzip of minified chunks, without three. */
interface Sizes {
  /** What an import of some of the exports fetches. */
  entry: number
  /** What it fetches only when it is needed, by the name of its module. */
  later: Record<string, number>
}

/** Of some of the exports; `plugins`: those of `three-diffraction/gltf`. */
async function bundleSizes(names: string, plugins = ''): Promise<Sizes> {
  const entry = join(consumer, `${names}${plugins}.js`.replaceAll(', ', '-'))
  await writeFile(
    entry,
    `export { ${names} } from 'three-diffraction'\nexport { ${plugins} } from 'three-diffraction/gltf'`,
  )
  const result = (await build({
    configFile: false,
    root: consumer,
    logLevel: 'error',
    ssr: { noExternal: true },
    build: {
      write: false,
      target: 'es2022',
      // As for a server: without what Vite itself adds to a page that imports chunks.
      ssr: true,
      minify: true,
      rolldownOptions: { input: entry, external: ['three'], preserveEntrySignatures: 'strict' },
    },
  })) as Rolldown.RolldownOutput
  const chunks = new Map(
    result.output.map((output) => [output.fileName, output as Rolldown.OutputChunk]),
  )
  const withImports = (name: string, seen = new Set<string>()): Set<string> => {
    if (!chunks.has(name) || seen.has(name)) return seen
    seen.add(name)
    for (const other of chunks.get(name)!.imports) withImports(other, seen)
    return seen
  }
  const sizeOf = (files: Iterable<string>): number =>
    [...files].reduce((sum, name) => sum + gzipped(chunks.get(name)!.code), 0)
  const first = withImports(result.output[0].fileName)
  const outside = [...first].flatMap((name) => chunks.get(name)!.imports)
  expect(new Set(outside.filter((name) => !chunks.has(name)))).toEqual(new Set(['three']))
  // Who does not import the plugins has nothing of them.
  const code = [...first].map((name) => chunks.get(name)!.code).join('')
  expect(code.includes('TDIFF_')).toBe(plugins !== '')
  const later = [...chunks.values()].filter(({ isDynamicEntry }) => isDynamicEntry)
  return {
    entry: sizeOf(first),
    later: Object.fromEntries(
      later.map(({ name, fileName }) => [
        name,
        sizeOf([...withImports(fileName)].filter((file) => !first.has(file))),
      ]),
    ),
  }
}
