import { existsSync, rmSync } from 'node:fs'
import { join } from 'node:path'
import type { Browser } from 'playwright-core'
import { afterAll, beforeAll, describe, expect, it } from 'vitest'
import { launchBrowser } from '../../scripts/browser.mjs'
import { collect } from '../../scripts/process.mjs'
import { serveFiles } from '../package/static-server'
import { codeBlocks, markdownFiles, root, type CodeBlock } from './markdown'
import { buildPages, folder, runInNode, typeErrors, writePrograms, type Program } from './programs'

declare global {
  interface Window {
    /** Of the page: what the block that it runs gives to the next. */
    given: ArrayBuffer
  }
}

const blocks = markdownFiles.flatMap(codeBlocks)
const kindOf = ({ language, rule }: CodeBlock): string => `${language ?? 'indented'} ${rule}`
const ofKind = (...kinds: string[]): CodeBlock[] =>
  blocks.filter((block) => kinds.includes(kindOf(block)))

/** What is done with each kind of block, and where. */
const RULES: Record<string, string> = {
  'ts run': 'type-checked, then run in Chromium: here',
  'tsx run': 'type-checked, then run in Chromium: here',
  'js run': 'type-checked, then run in Node: here',
  'ts check': "type-checked, for it names a file of the reader's own: here",
  'json gltf': 'checked by the schemas of the extension: tests/web/gltf-extension.test.ts',
  'text folders': 'names folders that are there: here',
  'http policy': 'obeyed by the pages of tests/package/consumers.test.ts',
  ...Object.fromEntries(
    ['evaluation', 'sidecar', 'edited', 'capture', 'distribution'].map((rule) => [
      `json ${rule}`,
      'read by precompute: tests/python/test_documentation.py',
    ]),
  ),
  'jsonl recipe': 'read by precompute, line by line: tests/python/test_documentation.py',
  'csv input': 'read by a command: tests/python/test_documentation.py',
  'sh run': 'run by the command line: tests/python/test_documentation.py',
  'sh node': 'run by Node in the repository: here',
  'sh parse': 'parsed by the command line: tests/python/test_documentation.py',
}

/** Equations and drawings that nothing can run. */
const FORMULAS = 'docs/theory/'

it('finds blocks of every kind', () => {
  expect([...new Set(blocks.map(kindOf))].sort()).toEqual(
    [...Object.keys(RULES), 'indented '].sort(),
  )
})

it('has a rule for every block', () => {
  const without = blocks.filter(
    (block) =>
      !(kindOf(block) in RULES || (block.language === null && block.file.startsWith(FORMULAS))),
  )
  expect(without.map((block) => `${block.file}:${block.line} ${kindOf(block)}`)).toEqual([])
})

describe('programs', () => {
  let programs: Program[]

  beforeAll(() => {
    programs = writePrograms(ofKind('ts run', 'ts check', 'tsx run', 'js run'))
  })

  it('have no type errors', () => {
    expect([...typeErrors(programs).values()].flat()).toEqual([])
  })

  it('run in Node', async () => {
    const scripts = programs.filter(({ block }) => block.language === 'js')
    for (const script of scripts) {
      const project = await runInNode(script)
      const { makes } = script.block.settings
      expect(makes, script.place).toBeDefined()
      expect(existsSync(join(project, makes!)), script.place).toBe(true)
    }
  })

  describe('in Chromium', () => {
    let browser: Browser
    let server: { url: string; close: () => Promise<void> }
    let pages: Map<Program, string>

    beforeAll(async () => {
      pages = await buildPages(programs.filter(({ block }) => /^tsx? run$/.test(kindOf(block))))
      server = await serveFiles([folder, root])
      browser = await launchBrowser({ backend: 'llvmpipe' })
    })

    afterAll(async () => {
      await browser.close()
      await server.close()
    })

    it('run without a complaint', async () => {
      // What the last page gave, for the next that takes it.
      let given: Buffer | null = null
      for (const [{ place, block }, name] of pages) {
        const page = await browser.newPage()
        const complaints: string[] = []
        const failed = new Promise<void>((resolve) => {
          const complain = (text: string): void => {
            complaints.push(`${place} ${text}`)
            resolve()
          }
          page.on('pageerror', (error) => {
            complain(String(error))
          })
          page.on('console', (message) => {
            if (['error', 'warning'].includes(message.type())) complain(message.text())
          })
        })
        const { gives, takes } = block.settings
        if (takes !== undefined) {
          const body = given!
          await page.route(`**/${takes}`, (route) => route.fulfill({ body }))
        }
        await page.goto(`${server.url}${name}.html`)
        await Promise.race([failed, page.waitForFunction(() => document.title === 'drawn')])
        if (gives !== undefined) {
          const bytes = await page.evaluate(() => [...new Uint8Array(window.given)])
          given = Buffer.from(bytes)
        }
        await page.close()
        expect(complaints).toEqual([])
      }
    })
  })
})

describe.each(ofKind('sh node'))('$file:$line', ({ code, settings }) => {
  it('runs and makes its file', async () => {
    const made = join(root, settings.makes!)
    rmSync(made, { force: true })
    const [node, ...words] = code.trim().split(/\s+/)
    expect(node).toBe('node')
    expect(await collect(process.execPath, words)).toMatchObject({ passed: true, problem: '' })
    expect(existsSync(made)).toBe(true)
  })
})

describe.each(ofKind('text folders'))('$file:$line', ({ code }) => {
  it('names folders that are there', () => {
    const folders = [...code.matchAll(/(\w+) \((?:Python|TypeScript|GLSL)\)/g)].map(
      ([, name]) => name!,
    )
    expect(folders.length).toBeGreaterThan(2)
    expect(folders.filter((name) => !existsSync(join(root, name)))).toEqual([])
  })
})
