import { describe, expect, it, vi } from 'vitest'
import type { Demo } from '../../demo/demo'
import type { Design } from '../../demo/design/design'
import { follow, linkTo } from '../../demo/link/link'
import { periodsSetting, strewnSetting } from '../../demo/link/designs'

const STREWN =
  'shape:discs,shape_mm:0.8,cover:5,shortest:1.2,longest:2.4,spread:0.02,size:512,tile_mm:25,height:0.15,profile:blazed,seed:7'
const POLYGONS = STREWN.replace('discs', 'polygons').replace('cover:5,', '')
const PERIODS = 'shortest:0.9,longest:2,bins:12,blend:sin2'

/** A page whose foil on show is made of what it is asked for. */
function page(): {
  demo: Demo
  strew: ReturnType<typeof vi.fn>
  givePeriods: ReturnType<typeof vi.fn>
} {
  const designs: { onShow: Partial<Design> | null } = { onShow: null }
  const strew = vi.fn((recipe: Design['recipe']) => {
    designs.onShow = { recipe, edited: null }
  })
  const givePeriods = vi.fn((edit: object) => {
    designs.onShow = { ...designs.onShow, edited: { edit } as Design['edited'] }
  })
  return {
    demo: { designs: Object.assign(designs, { strew, givePeriods }) } as unknown as Demo,
    strew,
    givePeriods,
  }
}

async function opened(query: string): Promise<ReturnType<typeof page> & { link: string }> {
  const { demo, ...others } = page()
  const settings = [strewnSetting(demo), periodsSetting(demo)]
  await follow(new URLSearchParams(query), settings)
  return { demo, ...others, link: new URL(linkTo('https://page/', settings)).search.slice(1) }
}

describe('a link to a foil that was made in the page', () => {
  it.each([
    '',
    `strewn=${STREWN}`,
    `strewn=${POLYGONS}`,
    `strewn=${STREWN}&periods=${PERIODS}`,
    `strewn=${STREWN.replace('seed:7', `seed:${Number.MAX_SAFE_INTEGER}`)}`,
    `strewn=${STREWN.replace('1.2', '1.2000000000000002')}`,
  ])('is read as it is written: %s', async (query) => {
    expect((await opened(query)).link).toBe(query)
  })

  it('states the recipe that is made', async () => {
    const { strew, givePeriods } = await opened(`strewn=${STREWN}&periods=${PERIODS}`)
    expect(strew).toHaveBeenCalledExactlyOnceWith({
      ...{ kind: 'foil', size: 512, tile_mm: 25, height: 0.15, profile: 'blazed', seed: 7 },
      design: 'stochastic',
      distribution: { kind: 'spiral', shortest: 1.2, longest: 2.4, spread: 0.02 },
      ...{ shape: 'discs', mask: null, shape_mm: 0.8, cover: 5 },
    })
    expect(givePeriods.mock.calls[0]![0]).toEqual({
      ...{ kind: 'period', shortest: 0.9, longest: 2, bins: 12, blend: 'sin2' },
    })
  })

  const wrong = (from: string, to: string): string => `strewn=${STREWN.replace(from, to)}`
  it.each([
    ['strewn=', 'strewn is "", expected each name once, with a colon before its value'],
    ['strewn=discs', 'strewn is "discs", expected each name once'],
    [`strewn=${STREWN},seed:8`, 'expected each name once'],
    [`strewn=${STREWN}:8`, 'expected each name once'],
    [`strewn=${STREWN},__proto__:8`, 'strewn.__proto__ is "8", expected one of shape, shape_mm'],
    [`strewn=${STREWN},bins:8`, 'strewn.bins is "8", expected one of shape, shape_mm'],
    [`strewn=${POLYGONS},cover:2`, 'strewn.cover is "2", expected one of shape, shape_mm'],
    [wrong('discs', 'stars'), 'strewn.shape is "stars", expected one of squares, discs, polygons'],
    [wrong('discs', 'constructor'), 'strewn.shape is "constructor", expected one of squares'],
    [wrong('blazed', '/elsewhere'), 'strewn.profile is "/elsewhere", expected one of sinusoidal'],
    [wrong('size:512', 'size:1025'), 'strewn.size is "1025", expected a number from 16 to 1024'],
    [wrong('size:512', 'size:1e9'), 'strewn.size is "1e9", expected a number from 16 to 1024'],
    [wrong('size:512', 'size:99.5'), 'strewn.size is "99.5", expected a whole number from 16'],
    [wrong('size:512', 'size:NaN'), 'strewn.size is "NaN", expected a number from 16'],
    [wrong('size:512,', ''), 'strewn.size is missing, expected a number from 16'],
    [wrong('seed:7', 'seed:-1'), 'strewn.seed is "-1", expected a number from 0 to'],
    [wrong('cover:5', 'cover:21'), 'strewn.cover is "21", expected a number from 0.01 to 20'],
    [wrong('shape_mm:0.8', 'shape_mm:0.01'), 'strewn.shape_mm is "0.01", expected two texels'],
    [wrong('longest:2.4', 'longest:1.2'), 'strewn.longest is "1.2", expected above the shortest'],
    [wrong('spread:0.02', 'spread:Infinity'), 'strewn.spread is "Infinity", expected a number'],
    // As many shapes as would keep the page busy for minutes.
    [
      wrong('shape_mm:0.8,cover:5', 'shape_mm:0.05,cover:20').replace('size:512', 'size:1024'),
      'strewn.cover is "20", expected at most 8 with',
    ],
    [`periods=${PERIODS.replace('12', '1e9')}`, 'periods.bins is "1e9", expected a number from 2'],
    [`periods=${PERIODS.replace('0.9', '3')}`, 'periods.longest is "2", expected the period at 0°'],
    [`periods=${PERIODS.replace(',bins:12', '')}`, 'periods.bins is missing, expected'],
    [`periods=${PERIODS},seed:1`, 'periods.seed is "1", expected one of shortest, longest'],
  ])('that says %s is refused', async (query, message) => {
    await expect(opened(query)).rejects.toThrow(message)
    await expect(opened(query)).rejects.toThrow(/^address: /)
  })
})
