import { execFile } from 'node:child_process'
import { mkdirSync, rmSync, writeFileSync } from 'node:fs'
import { basename, join, relative } from 'node:path'
import { promisify } from 'node:util'
import { build } from 'esbuild'
import ts from 'typescript'
import { root, type CodeBlock } from './markdown'

export const folder = join(root, 'tests', 'output', 'docs')
const GIVEN = join(root, 'tests', 'docs', 'given.ts')
/** What a reader installs, by its source. */
const PACKAGE = {
  'three-diffraction': join(root, 'web', 'index.ts'),
  'three-diffraction/gltf': join(root, 'web', 'gltf', 'index.ts'),
}

/** A block as a module of its own, in a file below the repository, where packages are found. */
export interface Program {
  block: CodeBlock
  /** `docs/page.md:12`. */
  place: string
  path: string
}

/** Writes blocks into files: one line that brings what is given, the block as it stands, what it gives to the next. */
export function writePrograms(blocks: readonly CodeBlock[]): Program[] {
  rmSync(folder, { recursive: true, force: true })
  mkdirSync(folder, { recursive: true })
  return blocks.map((block) => {
    const { file, line, language, settings, code } = block
    const path = join(folder, `${file.replace(/\W/g, '-')}-${line}.${language!}`)
    const given = settings.given?.split(',').join(', ')
    const preamble =
      given === undefined ? 'export {}' : `import { ${given} } from '${fromFolder(GIVEN)}'`
    const { gives } = settings
    const result = gives === undefined ? '' : `Object.assign(window, { given: ${gives} })`
    writeFileSync(path, `${preamble}\n${code}\n${result}\n`)
    return { block, place: `${file}:${line}`, path }
  })
}

function fromFolder(path: string): string {
  return relative(folder, path).replaceAll('\\', '/')
}

/** What the compiler has against each program, as strictly as it takes our own sources, by the line of its page. */
export function typeErrors(programs: readonly Program[]): Map<Program, string[]> {
  const config = ts.getParsedCommandLineOfConfigFile(
    join(root, 'tsconfig.json'),
    {},
    {
      ...ts.sys,
      onUnRecoverableConfigFileDiagnostic: (diagnostic) => {
        throw new Error(ts.flattenDiagnosticMessageText(diagnostic.messageText, '\n'))
      },
    },
  )!
  const program = ts.createProgram(
    [join(root, 'web', 'glsl.d.ts'), ...programs.map(({ path }) => path)],
    {
      ...config.options,
      // A block shows how something is made, not what is done with it then.
      noUnusedLocals: false,
      noEmit: true,
      paths: Object.fromEntries(Object.entries(PACKAGE).map(([name, path]) => [name, [path]])),
    },
  )
  return new Map(
    programs.map((one) => {
      const source = program.getSourceFile(one.path)
      if (source === undefined) throw new Error(`${one.path} was not read`)
      const found = [
        ...program.getSyntacticDiagnostics(source),
        ...program.getSemanticDiagnostics(source),
      ]
      return [one, found.map((diagnostic) => described(one.block, source, diagnostic))]
    }),
  )
}

function described(block: CodeBlock, source: ts.SourceFile, diagnostic: ts.Diagnostic): string {
  const { line } = source.getLineAndCharacterOfPosition(diagnostic.start ?? 0)
  const text = ts.flattenDiagnosticMessageText(diagnostic.messageText, ' ')
  // The first line of the file is the preamble.
  return `${block.file}:${block.line + line - 1} ${text}`
}

/** Bundles programs for the browser, from the package's sources: a page `NAME.html` for each. */
export async function buildPages(programs: readonly Program[]): Promise<Map<Program, string>> {
  const names = new Map(programs.map((program) => [program, nameOf(program)]))
  for (const [{ path, block }, name] of names) {
    const main = [
      `import { drawn } from '${fromFolder(join(root, 'tests', 'docs', 'drawn.ts'))}'`,
      `await import('./${basename(path)}')`,
      `await drawn(${block.settings.frames ?? 1})`,
      `document.title = 'drawn'`,
    ]
    writeFileSync(join(folder, `${name}.main.ts`), main.join('\n'))
    writeFileSync(
      join(folder, `${name}.html`),
      `<!doctype html><body><script type="module" src="pages/${name}.main.js"></script>`,
    )
  }
  await build({
    entryPoints: [...names.values()].map((name) => join(folder, `${name}.main.ts`)),
    outdir: join(folder, 'pages'),
    bundle: true,
    splitting: true,
    format: 'esm',
    target: 'es2022',
    define: { 'process.env.NODE_ENV': '"production"' },
    plugins: [
      {
        name: 'package',
        setup: (bundler) => {
          bundler.onResolve({ filter: /^three-diffraction(\/|$)/ }, ({ path }) => ({
            path: PACKAGE[path as keyof typeof PACKAGE],
          }))
          // Vite's way of asking for a file's text.
          bundler.onResolve({ filter: /\.glsl\?raw$/ }, ({ path, resolveDir }) => ({
            path: join(resolveDir, path.replace(/\?raw$/, '')),
          }))
        },
      },
    ],
    loader: { '.glsl': 'text' },
  })
  return names
}

function nameOf({ path }: Program): string {
  return basename(path).replace(/\.\w+$/, '')
}

/** Runs a program in Node, in an empty folder, which it returns. */
export async function runInNode(program: Program): Promise<string> {
  const project = join(folder, nameOf(program))
  mkdirSync(project)
  await promisify(execFile)(process.execPath, [program.path], { cwd: project })
  return project
}
