import { readdirSync, readFileSync } from 'node:fs'
import { join } from 'node:path'
import { fileURLToPath } from 'node:url'
import type { Root } from 'mdast'
import { remark } from 'remark'
import remarkGfm from 'remark-gfm'
import { visit } from 'unist-util-visit'
import { filesUnder } from '../../scripts/stamp.mjs'

export const root = fileURLToPath(new URL('../../', import.meta.url))

/** What is installed, baked or generated. */
const NOT_OURS = /^(node_modules|dist|maps|docs\/api|tests\/output|\..*)(\/|$)/

/** Every Markdown file that is written by hand or by the report, relative to the repository. */
export const markdownFiles = readdirSync(root)
  .filter((name) => !NOT_OURS.test(name))
  .flatMap(filesUnder)
  .filter((file) => file.endsWith('.md') && !NOT_OURS.test(file))

/** A Markdown file as GitHub understands it. */
export function parsed(file: string): Root {
  return remark()
    .use(remarkGfm)
    .parse(readFileSync(join(root, file), 'utf8'))
}

/**
 * A code block. The words after its language, which no reader sees, say what the tests do with it: first the rule, then
 * what the rule has to know, as `name=value`.
 */
export interface CodeBlock {
  file: string
  /** Of the block's first line of code. */
  line: number
  /** Null where it is indented and not fenced. */
  language: string | null
  rule: string
  settings: Record<string, string | undefined>
  code: string
}

export function codeBlocks(file: string): CodeBlock[] {
  const blocks: CodeBlock[] = []
  visit(parsed(file), 'code', ({ lang, meta, value, position }) => {
    const [rule = '', ...settings] = meta?.split(/\s+/) ?? []
    blocks.push({
      file,
      line: position!.start.line + 1,
      language: lang ?? null,
      rule,
      settings: Object.fromEntries(settings.map((setting) => setting.split('=', 2))) as Record<
        string,
        string
      >,
      code: value,
    })
  })
  return blocks
}
