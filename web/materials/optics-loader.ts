import { DiffractionError } from '../errors.ts'
import { roughEnvironment } from '../lazy-code.ts'
import { loadSharedMap } from '../maps/cache.ts'
import type { LoadedMap } from '../maps/load.ts'
import type { Optics, OpticsSettings, Surface } from '../surfaces/surface.ts'

type LoaderState = 'loading' | 'ready' | 'failed'

/**
 * Keeps a surface's optics in step with the settings; tables are fetched when their addresses change, code for rough
 * surfaces when the first is asked for.
 */
export class OpticsLoader {
  state: LoaderState = 'loading'
  /** Settles when the last request has; failures are also given to `onError`. */
  ready: Promise<void> = Promise.resolve()
  error: DiffractionError | null = null

  #tables: Record<string, LoadedMap> = {}
  #addresses = ''
  #request = 0

  /** @param maps - are taken in the place of what their addresses would fetch */
  constructor(
    private readonly apply: (optics: Optics) => void,
    private readonly onError: (error: DiffractionError) => void,
    public maps: Readonly<Record<string, LoadedMap>>,
  ) {}

  /**
   * Asks for the optics of a surface under these settings: at once where the tables are at hand (and then what does not
   * fit is thrown) and nothing takes long, later otherwise. What was last good stays until then, or for good.
   */
  request(surface: Surface, settings: OpticsSettings, mapsPath: string): void {
    const wanted = surface.tables(settings, mapsPath)
    const addresses = JSON.stringify(wanted)
    // Thrown before anything has changed, where it does not fit.
    const optics = addresses === this.#addresses ? surface.optics(this.#tables, settings) : null
    const request = ++this.#request
    const isWanted = (): boolean => request === this.#request
    const isRough = settings.roughness > 0 && settings.method === 'closed-form'
    const code = isRough ? roughEnvironment.load() : Promise.resolve()
    const preparing = optics?.prepare?.(isWanted) ?? null
    if (optics !== null && preparing === null) {
      this.#use(optics)
      this.#await(code, request)
      return
    }
    this.state = 'loading'
    const loading = Promise.all([
      optics === null ? this.#load(wanted) : this.#tables,
      code,
      preparing,
    ]).then(async ([tables]) => {
      // A later request has its own tables and settings; whoever waits for this one is told when they are in use.
      if (!isWanted()) return this.ready
      const fitting = optics ?? surface.optics(tables, settings)
      if (optics === null) await fitting.prepare?.(isWanted)
      if (!isWanted()) return this.ready
      this.#tables = tables
      this.#addresses = addresses
      this.#use(fitting)
    })
    this.#await(loading, request)
  }

  /** Requests by `then` once code has come on which the request depends; another request takes its place. */
  requestAfter(code: Promise<void>, then: () => void): void {
    const request = ++this.#request
    this.state = 'loading'
    const requested = code.then(() => {
      if (request !== this.#request) return
      then()
      return this.ready
    })
    this.#await(requested, request)
  }

  #use(optics: Optics): void {
    this.apply(optics)
    this.state = 'ready'
    this.error = null
  }

  #await(loading: Promise<void>, request: number): void {
    this.ready = loading.catch((cause: unknown) => {
      const error = asDiffractionError(cause)
      if (request === this.#request) {
        this.state = 'failed'
        this.error = error
        this.onError(error)
      }
      throw error
    })
    // Whoever awaits `ready` hears of a failure; nobody has to.
    this.ready.catch(() => undefined)
  }

  async #load(wanted: Record<string, string>): Promise<Record<string, LoadedMap>> {
    const entries = await Promise.all(
      Object.entries(wanted).map(
        async ([name, url]) => [name, this.maps[url] ?? (await loadSharedMap(url))] as const,
      ),
    )
    return Object.fromEntries(entries)
  }
}

function asDiffractionError(cause: unknown): DiffractionError {
  if (cause instanceof DiffractionError) return cause
  return new DiffractionError(
    { file: 'maps', field: 'tables', value: String(cause), expected: 'tables and code that load' },
    { cause },
  )
}
