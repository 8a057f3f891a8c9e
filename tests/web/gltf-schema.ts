import { readdirSync, readFileSync } from 'node:fs'
import { Ajv2020, type ValidateFunction } from 'ajv/dist/2020.js'
import { EXTENSION } from '../../web/gltf'
import type { Json } from './gltf-files'

const folder = new URL('../../docs/gltf/schema/', import.meta.url)

/** What of glTF's own schemas ours refer to. */
const GLTF_PROPERTY = {
  $id: 'glTFProperty.schema.json',
  type: 'object',
  properties: { extensions: { type: 'object' }, extras: {} },
}
const CORE = [
  GLTF_PROPERTY,
  { $id: 'glTFid.schema.json', type: 'integer', minimum: 0 },
  {
    $id: 'textureInfo.schema.json',
    type: 'object',
    allOf: [{ $ref: GLTF_PROPERTY.$id }],
    properties: {
      index: { $ref: 'glTFid.schema.json' },
      texCoord: { type: 'integer', minimum: 0 },
    },
    required: ['index'],
  },
]

const ajv = new Ajv2020({ strict: true, strictTypes: false, strictRequired: false })
for (const schema of CORE) ajv.addSchema(schema)
for (const name of readdirSync(folder))
  ajv.addSchema(JSON.parse(readFileSync(new URL(name, folder), 'utf8')) as object)

function validator(owner: string): ValidateFunction {
  return ajv.getSchema(`${owner}.${EXTENSION}.schema.json`)!
}

/** What the schemas have against the extension in a glTF: in its materials, and in the file. */
export function schemaErrors(file: Json): string[] {
  const owners = [
    ...((file.materials ?? []) as Json[]).map((material) => ['material', material] as const),
    ['glTF', file] as const,
  ]
  return owners.flatMap(([name, owner]) => {
    const json = (owner.extensions as Json | undefined)?.[EXTENSION]
    const validate = validator(name)
    if (json === undefined || validate(json)) return []
    return validate.errors!.map(({ instancePath, message }) => `${name}${instancePath} ${message!}`)
  })
}
