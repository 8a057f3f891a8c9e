/** The text of a shader file, as the bundler inlines it. */
declare module '*.glsl?raw' {
  const source: string
  export default source
}
