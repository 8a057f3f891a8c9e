/** What the tests use of Khronos' validator, which has no declarations. */
declare module 'gltf-validator' {
  export interface ValidationReport {
    issues: {
      numErrors: number
      numWarnings: number
      messages: { code: string; severity: number; pointer: string; message: string }[]
    }
  }
  export function validateBytes(
    data: Uint8Array,
    options?: { maxIssues?: number },
  ): Promise<ValidationReport>
}
