import { Texture, type ShaderMaterial, type WebGLRenderer } from 'three'

/** A texture of the material's own, as the shader has it. */
export interface TableSize {
  uniform: string
  width: number
  height: number
  bytes: number
}

/** The fragment shader that a material was last drawn with: three's prefix, all includes, all loops unrolled. */
export function fragmentShaderOf(renderer: WebGLRenderer, material: ShaderMaterial): string {
  const { gl, program } = programOf(renderer, material)
  const shaders = gl.getAttachedShaders(program) ?? []
  const fragment = shaders.find(
    (shader) => gl.getShaderParameter(shader, gl.SHADER_TYPE) === gl.FRAGMENT_SHADER,
  )
  if (fragment === undefined) throw new Error('The program has no fragment shader')
  return gl.getShaderSource(fragment) ?? ''
}

/** The textures that a material's last program reads, but for the environment, which is the scene's. */
export function tablesOf(renderer: WebGLRenderer, material: ShaderMaterial): TableSize[] {
  const { gl, program } = programOf(renderer, material)
  const tables: TableSize[] = []
  for (const [uniform, { value }] of Object.entries(material.uniforms)) {
    // WebGL drops uniforms that no statement of the program reads.
    if (uniform === 'uEnvironmentMap' || gl.getUniformLocation(program, uniform) === null) continue
    if (!(value instanceof Texture)) continue
    const image = value.image as {
      width: number
      height: number
      depth?: number
      data: ArrayBufferView | null
    }
    const { width, height, depth = 1, data } = image
    // What was drawn has no data on this side: four half floats a texel.
    tables.push({ uniform, width, height, bytes: data?.byteLength ?? 8 * width * height * depth })
  }
  return tables
}

function programOf(
  renderer: WebGLRenderer,
  material: ShaderMaterial,
): { gl: WebGL2RenderingContext; program: WebGLProgram } {
  const { currentProgram } = renderer.properties.get(material) as {
    currentProgram: { program: WebGLProgram }
  }
  return { gl: renderer.getContext() as WebGL2RenderingContext, program: currentProgram.program }
}
