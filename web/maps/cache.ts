import { loadMap, type LoadedMap } from './load.ts'

const loads = new Map<string, Promise<LoadedMap>>()

/**
 * {@link loadMap}, once for each address: materials share their tables. A load that failed is tried anew.
 *
 * @param url - the map's address without extension
 */
export function loadSharedMap(url: string): Promise<LoadedMap> {
  const known = loads.get(url)
  if (known !== undefined) return known
  const load = loadMap(url)
  loads.set(url, load)
  load.catch(() => loads.delete(url))
  return load
}
