// Times materials in Chromium on one thread of llvmpipe and prints the shortest frame of each, ms, as JSON.
//
//   node tests/browser/time.mjs REQUEST.json        (TimingRequest in harness/timing.ts)
//
// Read ratios within one run: milliseconds vary twofold from one to the next.
import { readFile } from 'node:fs/promises'
import { openHarness } from './open-harness.mjs'

const [file] = process.argv.slice(2)
if (file === undefined) {
  console.error('Usage: node tests/browser/time.mjs REQUEST.json')
  process.exit(2)
}

const request = JSON.parse(await readFile(file, 'utf8'))
const harness = await openHarness({ env: { LP_NUM_THREADS: '1' } })
try {
  console.log(JSON.stringify(await harness.timeMaterials(request), null, 1))
} finally {
  await harness.close()
}
