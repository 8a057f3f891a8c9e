// Times materials in Chromium on one thread of llvmpipe, all in one launch.
//
//   node tests/browser/time.mjs REQUEST.json …        (TimingRequest in harness/timing.ts)
//
// Prints a line of JSON for each request: its file's name, and the shortest frame of each material in ms. Read ratios
// within one request: milliseconds vary twofold from one launch to the next.
import { readFile } from 'node:fs/promises'
import { basename } from 'node:path'
import { openHarness } from './open-harness.mjs'

const files = process.argv.slice(2)
if (files.length === 0) {
  console.error('Usage: node tests/browser/time.mjs REQUEST.json …')
  process.exit(2)
}

const harness = await openHarness({ env: { LP_NUM_THREADS: '1' } })
try {
  for (const file of files) {
    const milliseconds = await harness.timeMaterials(JSON.parse(await readFile(file, 'utf8')))
    console.log(JSON.stringify({ request: basename(file, '.json'), milliseconds }))
  }
} finally {
  await harness.close()
}
