import {
  ReflectionKind,
  type DeclarationReflection,
  type ParameterReflection,
  type ProjectReflection,
  type SignatureReflection,
  type SomeType,
} from 'typedoc'

/** One thing that a reader of the API meets: an export, a member, a parameter or what a function returns. */
interface Entry {
  /** `Grating.period`, `loadMap(url)`, `loadMap()`. */
  name: string
  type: SomeType | undefined
  /** What is said of it. */
  text: string
}

/** Units, as they are written in doc comments. */
const UNIT = /(?<![\p{L}\d])(µm|mm|rad|degrees|pixels?|texels?|bytes?|ms)(?![\p{L}\d])/u
/** Words of quantities that have none: pure numbers, shares of a whole, things that are counted. */
const NO_UNIT =
  /\b(no unit|share|factor|refractive index|roughness as three counts it|relative|number of|how many|counts|index|tiles|nodes|frames)\b/i

/** What of the API nothing is said about. */
export function undocumented(project: ProjectReflection): string[] {
  return entriesOf(project)
    .filter(({ text }) => text === '')
    .map(({ name }) => name)
}

/** What of the API is a quantity whose unit is not said, nor that it has none. */
export function withoutUnit(project: ProjectReflection): string[] {
  return entriesOf(project)
    .filter(({ type, text }) => isQuantity(type) && !UNIT.test(text) && !NO_UNIT.test(text))
    .map(({ name, text }) => `${name}: ${text}`)
}

export function entriesOf(project: ProjectReflection): Entry[] {
  const { Module } = ReflectionKind
  return (project.children ?? []).flatMap((child) =>
    child.kind === Module
      ? [
          { name: child.name, type: undefined, text: textOf(child) },
          ...(child.children ?? []).flatMap((exported) => entriesOfDeclaration(exported, '')),
        ]
      : entriesOfDeclaration(child, ''),
  )
}

function entriesOfDeclaration(declaration: DeclarationReflection, owner: string): Entry[] {
  const name = owner + declaration.name
  const accessor = declaration.getSignature ?? declaration.setSignature
  if (accessor !== undefined) {
    const type = declaration.getSignature?.type ?? declaration.setSignature?.parameters?.[0]?.type
    return [{ name, type, text: textOf(accessor) }]
  }
  if (declaration.signatures !== undefined)
    return declaration.signatures.flatMap((signature) => entriesOfSignature(signature, owner))
  const callback = callbackOf(declaration.type)
  if (callback !== null)
    return [
      { name, type: undefined, text: textOf(declaration) },
      { name: `${name}()`, type: callback.type, text: textOf(declaration) },
    ]
  return [
    { name, type: declaration.type, text: textOf(declaration) },
    ...(declaration.children ?? []).flatMap((child) => entriesOfDeclaration(child, `${name}.`)),
  ]
}

function entriesOfSignature(signature: SignatureReflection, owner: string): Entry[] {
  const isConstructor = signature.kind === ReflectionKind.ConstructorSignature
  const name = owner + (isConstructor ? 'constructor' : signature.name)
  const text = textOf(signature)
  const returns = signature.comment?.getTag('@returns')
  return [
    // What a constructor does its class says; what a function gives is said by itself or apart.
    ...(isConstructor
      ? []
      : [{ name: `${name}()`, type: signature.type, text: plain(returns?.content) || text }]),
    ...(signature.parameters ?? []).map((parameter) => ({
      name: `${name}(${parameter.name})`,
      type: parameter.type,
      text: textOf(parameter) || whatItsTypeSays(parameter),
    })),
  ]
}

/** Options and the package's own classes say what they are where they are declared. */
function whatItsTypeSays({ type }: ParameterReflection): string {
  if (type?.type !== 'reference') return ''
  const { reflection } = type
  return reflection?.isDeclaration() === true ? textOf(reflection) : ''
}

function textOf(reflection: { comment?: SignatureReflection['comment'] }): string {
  return plain(reflection.comment?.summary)
}

function plain(parts: readonly { text: string }[] | undefined): string {
  return (parts ?? [])
    .map(({ text }) => text)
    .join('')
    .replace(/\s+/g, ' ')
    .trim()
}

function callbackOf(type: SomeType | undefined): SignatureReflection | null {
  return (type?.type === 'reflection' && type.declaration.signatures?.[0]) || null
}

function isText(type: SomeType): boolean {
  return type.type === 'intrinsic' && type.name === 'string'
}

/** Numbers, lists of them, and vectors. */
function isQuantity(type: SomeType | undefined): boolean {
  switch (type?.type) {
    case 'intrinsic':
      return type.name === 'number'
    case 'array':
      return isQuantity(type.elementType)
    case 'tuple':
      return type.elements.some((element) => isQuantity(element))
    case 'typeOperator':
      return isQuantity(type.target)
    case 'union':
      // Defines are numbers or text.
      return type.types.some(isQuantity) && !type.types.some(isText)
    case 'reference':
      if (/^(Vector[234]|Euler|Float32Array)$/.test(type.name)) return true
      return (
        ['Promise', 'Record'].includes(type.name) && (type.typeArguments ?? []).some(isQuantity)
      )
    default:
      return false
  }
}
