import { DiffractionError } from '../../web'
import type { Demo } from '../demo'
import { DEFAULT_NAME } from '../design/design'
import { readEdit, textsOfEdit } from '../design/period-edit'
import { readRecipe, textsOf } from '../design/stochastic-recipe'
import type { Texts } from '../design/values'
import { ADDRESS, type Setting } from './setting'

/** The shapes that were strewn for the foil on show. */
export function strewnSetting({ designs }: Demo): Setting {
  return {
    name: 'strewn',
    read: () => {
      const recipe = designs.onShow?.recipe ?? null
      return recipe === null ? undefined : textOf(textsOf(recipe))
    },
    write: async (text) => {
      await designs.strew(valueOf('strewn', text, readRecipe, textsOf))
    },
  }
}

/** The periods that the gratings of the foil on show were given. */
export function periodsSetting({ designs }: Demo): Setting {
  return {
    name: 'periods',
    read: () => {
      const edited = designs.onShow?.edited ?? null
      return edited === null ? undefined : textOf(textsOfEdit(edited.edit))
    },
    write: async (text) => {
      await designs.givePeriods(valueOf('periods', text, readEdit, textsOfEdit), DEFAULT_NAME)
    },
  }
}

/** Values by name as an address states them, as in `shortest:1.2,bins:12`. */
function textOf(texts: Texts): string {
  return Object.entries(texts)
    .map(([name, text]) => `${name}:${text ?? ''}`)
    .join(',')
}

/** What such a text states; throws a DiffractionError that names what of it cannot be used. */
function valueOf<T>(
  setting: string,
  text: string,
  read: (texts: Texts) => T,
  write: (value: T) => Texts,
): T {
  const refuse = (field: string, value: unknown, expected: string): never => {
    throw new DiffractionError({ file: ADDRESS, field, value, expected })
  }
  const stated = new Map<string, string>()
  for (const entry of text.split(',')) {
    const [name, value, ...more] = entry.split(':')
    if (name === undefined || value === undefined || more.length > 0 || stated.has(name))
      return refuse(setting, text, 'each name once, with a colon before its value')
    stated.set(name, value)
  }
  const texts: Texts = Object.fromEntries(stated)
  let value: T
  try {
    value = read(texts)
  } catch (error) {
    if (!(error instanceof DiffractionError)) throw error
    return refuse(`${setting}.${error.field}`, texts[error.field], error.expected)
  }
  const names = Object.keys(write(value))
  for (const [name, given] of stated)
    if (!names.includes(name)) refuse(`${setting}.${name}`, given, `one of ${names.join(', ')}`)
  return value
}
