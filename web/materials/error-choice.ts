import {
  EFFICIENCIES,
  type Feature,
  type OpticsSettings,
  type Surface,
} from '../surfaces/surface.ts'
import measuredErrors from './measured-errors.json'
import { DEFAULT_SETTINGS, type ChosenSettings } from './options.ts'

/** What a method is chosen for: scenes under lights alone, and scenes in an environment. */
const PARTS = [
  { part: 'lights', knob: 'wavelengthStep', under: 'under lights' },
  { part: 'environment', knob: 'environmentNodes', under: 'in environments' },
] as const
type Part = (typeof PARTS)[number]

/** One way to draw, with its worst error and longest frame over all scenes of its class in the report. */
interface MeasuredSetting {
  /** The material's options, its defaults where missing. */
  options: Record<string, string | number>
  rel_rmse: number
  /** Over MeshStandardMaterial's frame. */
  time_ratio: number
}

interface Measured {
  /** How many the class has. */
  scenes: number
  settings: readonly MeasuredSetting[]
}

/** What the report has measured, by class of surface (`Surface.measuredAs`) and by what lights it. */
export type MeasuredErrors = Record<string, Partial<Record<Part['part'], Measured>>>

/** Made by the report from its rows: precompute/report/measured_errors.py. */
export const MEASURED_ERRORS = measuredErrors.classes as unknown as MeasuredErrors

export interface ErrorChoice {
  settings: Partial<ChosenSettings>
  /** What was chosen, what it rests on, and where it is not enough. */
  features: readonly Feature[]
}

/**
 * The settings for which the report has measured the least time among those that erred by at most `maxError` in all
 * scenes of the surface's class, under lights and in environments both; where there are none, those that erred least.
 * Only methods whose maps are there are chosen from: those that read the same ones, and those that the surface knows of.
 *
 * @param surface - what is drawn
 * @param settings - those that hold where nothing else is chosen
 * @param given - names of settings that were given, and stay
 * @param maxError - relative root mean square error of radiance, above 0
 */
export function choiceForError(
  surface: Surface,
  settings: Readonly<OpticsSettings>,
  given: ReadonlySet<string>,
  maxError: number,
  measured: MeasuredErrors = MEASURED_ERRORS,
): ErrorChoice {
  const name = surface.measuredAs(settings)
  const ofClass = measured[name] ?? {}
  const addresses = (method: OpticsSettings['method']): string =>
    JSON.stringify(surface.tables({ ...settings, method }, ''))
  const own = addresses(settings.method)
  const known = surface.methodsKnown(settings)
  const methods = surface.methods.filter((method) =>
    given.has('method')
      ? method === settings.method
      : addresses(method) === own || known.includes(method),
  )

  let best: Plan | null = null
  for (const method of methods)
    for (const efficiencies of EFFICIENCIES) {
      if (given.has('efficiencies') && efficiencies !== settings.efficiencies) continue
      const wanted = { ...settings, method, efficiencies }
      const plan = planFor(wanted, ofClass, given, maxError)
      if (plan !== null && (best === null || isBetter(plan, best))) best = plan
    }
  return {
    settings: best === null ? {} : settingsOf(best, given),
    features: PARTS.map((part) => describe(best, part, name, ofClass[part.part], maxError)),
  }
}

interface Plan {
  method: OpticsSettings['method']
  efficiencies: OpticsSettings['efficiencies']
  /** For each part, where something was measured. */
  picks: Partial<Record<Part['part'], MeasuredSetting>>
  /** The worst error of the picks that err by too much; 0 where none does. */
  excess: number
  /** Sum of the picks' frames. */
  time: number
}

function planFor(
  wanted: OpticsSettings,
  ofClass: MeasuredErrors[string],
  given: ReadonlySet<string>,
  maxError: number,
): Plan | null {
  const picks: Plan['picks'] = {}
  for (const part of PARTS) {
    const settings = ofClass[part.part]?.settings ?? []
    const pick = leastTime(
      settings.filter((setting) => fits(setting, part, wanted, given)),
      maxError,
    )
    if (pick !== null) picks[part.part] = pick
  }
  const made = Object.values(picks)
  if (made.length === 0) return null
  const { method, efficiencies } = wanted
  const excess = Math.max(...made.map(({ rel_rmse }) => (rel_rmse <= maxError ? 0 : rel_rmse)))
  const time = made.reduce((sum, { time_ratio }) => sum + time_ratio, 0)
  return { method, efficiencies, picks, excess, time }
}

/** Whether a measured setting is one of the wanted method, and leaves alone what was given. */
function fits(
  { options }: MeasuredSetting,
  { knob }: Part,
  wanted: OpticsSettings,
  given: ReadonlySet<string>,
): boolean {
  const { method = wanted.method, efficiencies = 'table', ...knobs } = options
  if (method !== wanted.method || efficiencies !== wanted.efficiencies) return false
  if (Object.keys(knobs).some((name) => name !== knob)) return false
  return !given.has(knob) || knobOf(options, knob) === wanted[knob]
}

/** The fastest of those that err little enough; where there are none, the one that errs least. */
function leastTime(settings: readonly MeasuredSetting[], maxError: number): MeasuredSetting | null {
  const enough = settings.filter(({ rel_rmse }) => rel_rmse <= maxError)
  const by: keyof MeasuredSetting = enough.length > 0 ? 'time_ratio' : 'rel_rmse'
  const [first] = (enough.length > 0 ? enough : [...settings]).sort((a, b) => a[by] - b[by])
  return first ?? null
}

function isBetter(plan: Plan, than: Plan): boolean {
  // A method that was measured for more of what can light the surface comes first.
  const [parts, partsOfOther] = [plan, than].map(({ picks }) => Object.keys(picks).length)
  if (parts !== partsOfOther) return parts! > partsOfOther!
  return plan.excess === than.excess ? plan.time < than.time : plan.excess < than.excess
}

function settingsOf(
  { method, efficiencies, picks }: Plan,
  given: ReadonlySet<string>,
): Partial<ChosenSettings> {
  const settings: Partial<ChosenSettings> = { method, efficiencies }
  for (const { part, knob } of PARTS)
    if (picks[part] && !given.has(knob)) settings[knob] = knobOf(picks[part].options, knob)
  return settings
}

function knobOf(options: MeasuredSetting['options'], knob: Part['knob']): number {
  return Number(options[knob] ?? DEFAULT_SETTINGS[knob])
}

function describe(
  plan: Plan | null,
  { part, knob, under }: Part,
  name: string,
  measured: Measured | undefined,
  maxError: number,
): Feature {
  const feature = `error ${under} of at most ${maxError}`
  const pick = plan?.picks[part]
  if (plan === null || pick === undefined) {
    const why =
      measured === undefined
        ? `the report has measured no ${name} ${under}`
        : 'the report has not measured the settings that were given'
    return { feature, included: false, why }
  }
  const { options, rel_rmse } = pick
  const isLoop = knob in options
  const chosen = knob === 'environmentNodes' || isLoop ? `, ${knob} ${knobOf(options, knob)}` : ''
  const how = `method '${plan.method}'${chosen}`
  const found = `was at most ${rel_rmse} off in the report's ${measured!.scenes} scenes of a ${name} ${under}`
  const included = rel_rmse <= maxError
  const least = included ? '' : ', the least that can be chosen'
  return { feature, included, why: `${how}: ${found}${least}` }
}
