import { launchBrowser, serve } from '../../scripts/browser.mjs'

/**
 * Opens the harness page in Chromium.
 *
 * @param {{ backend?: 'llvmpipe' | 'swiftshader', env?: Record<string, string> }} [options]
 *   env: variables for the browser, such as LP_NUM_THREADS
 */
export async function openHarness({ backend = 'llvmpipe', env = {} } = {}) {
  const server = await serve('tests/browser/harness')
  const browser = await launchBrowser({ backend, env }).catch(async (error) => {
    await server.close()
    throw error
  })
  const close = async () => {
    await browser.close()
    await server.close()
  }
  try {
    const page = await browser.newPage()
    /** @type {string[]} */
    const complaints = []
    page.on('console', (message) => {
      if (['error', 'warning'].includes(message.type())) complaints.push(message.text())
    })
    page.on('pageerror', (error) => complaints.push(String(error)))
    await page.goto(server.url)
    await page
      .waitForFunction(() => window.harness !== undefined)
      .catch((error) => {
        throw new Error(`${String(error)}\n${complaints.join('\n')}`)
      })
    return {
      page,
      /** What the page wrote as errors and warnings so far. */
      complaints,
      backend: await page.evaluate(() => window.harness.backend),
      /** @param {import('./harness/scene-description').SceneDescription} scene */
      renderScene: (scene) => page.evaluate((s) => window.harness.renderScene(s), scene),
      /** @param {import('./harness/timing').TimingRequest} request */
      timeMaterials: (request) => page.evaluate((r) => window.harness.timeMaterials(r), request),
      close,
    }
  } catch (error) {
    await close()
    throw error
  }
}
