import { existsSync, readFileSync } from 'node:fs'
import { dirname, join, normalize } from 'node:path'
import GithubSlugger from 'github-slugger'
import { visit } from 'unist-util-visit'
import { describe, expect, it } from 'vitest'
import { filesUnder } from '../../scripts/stamp.mjs'
import { markdownFiles, parsed, root } from './markdown'

/** The anchors that GitHub gives a file's headings. */
function anchorsOf(file: string): Set<string> {
  const slugger = new GithubSlugger()
  const found = new Set<string>()
  visit(parsed(file), 'heading', (heading) => {
    let text = ''
    visit(heading, (node) => {
      if (node.type === 'text' || node.type === 'inlineCode') text += node.value
    })
    found.add(slugger.slug(text))
  })
  return found
}

const anchors = new Map(markdownFiles.map((file) => [file, anchorsOf(file)]))

/** The addresses of a file's links and pictures, but for other sites'. */
function addressesIn(file: string): string[] {
  const addresses: string[] = []
  visit(parsed(file), (node) => {
    if (node.type === 'link' || node.type === 'image' || node.type === 'definition')
      addresses.push(node.url)
    // Reference links without their definition are text to the parser.
    if (node.type === 'text' && /\]\[|\]\(/.test(node.value)) addresses.push(node.value)
    // Pictures whose size is stated.
    if (node.type === 'html')
      for (const [, address] of node.value.matchAll(/(?:href|src)="([^"]*)"/g))
        addresses.push(address!)
  })
  return addresses.filter((address) => !/^(https?|mailto):/.test(address))
}

/** Why an address in a file leads nowhere; null where it leads somewhere. */
export function deadEnd(file: string, address: string): string | null {
  const [path = '', anchor] = address.split('#', 2)
  const target = path === '' ? file : normalize(join(dirname(file), decodeURIComponent(path)))
  if (target.startsWith('..')) return 'leaves the repository'
  const place = join(root, target)
  if (!existsSync(place)) return `there is no ${target}`
  if (anchor === undefined) return null
  const known = anchors.get(target)
  if (known === undefined) return `${target} has no anchors`
  return known.has(anchor) ? null : `${target} has no heading #${anchor}`
}

it('finds the pages', () => {
  expect(markdownFiles).toEqual(
    expect.arrayContaining(['README.md', 'docs/theory/README.md', 'docs/gltf/README.md']),
  )
})

describe.each(markdownFiles)('%s', (file) => {
  it('has links that lead somewhere', () => {
    const dead = addressesIn(file).flatMap((address) => {
      const why = deadEnd(file, address)
      return why === null ? [] : [`${address}: ${why}`]
    })
    expect(dead).toEqual([])
  })
})

it('finds each page that a comment in the sources names', () => {
  const sources = ['demo', 'precompute', 'shaders', 'web']
    .flatMap(filesUnder)
    .filter((file) => /\.(glsl|py|tsx?)$/.test(file))
  const named = sources.flatMap((file) =>
    [...readFileSync(join(root, file), 'utf8').matchAll(/docs\/[\w/-]+\.md/g)].map(([page]) => ({
      file,
      page,
    })),
  )
  expect(named.length).toBeGreaterThan(20)
  expect(named.filter(({ page }) => !existsSync(join(root, page)))).toEqual([])
})

it.each([
  ['theory.md', 'there is no theory.md'],
  ['docs/theory/README.md#9-nothing', 'docs/theory/README.md has no heading #9-nothing'],
  ['#nothing', 'README.md has no heading #nothing'],
  ['docs#theory', 'docs has no anchors'],
  ['../x.md', 'leaves the repository'],
])('sees that README.md cannot link to %s', (address, why) => {
  expect(deadEnd('README.md', address)).toBe(why)
})
