/** What a browser lacks, in words for whoever reads the page. */
export class UnsupportedError extends Error {}

/** A WebGL2 context that can do what the page needs; throws an UnsupportedError where there is none. */
export function requireContext(canvas: HTMLCanvasElement): WebGL2RenderingContext {
  const context = canvas.getContext('webgl2', {
    // Drawn into targets of its own size and depth; the canvas takes the finished picture.
    antialias: false,
    depth: false,
    alpha: false,
    powerPreference: 'high-performance',
  })
  if (context === null)
    throw new UnsupportedError(
      'It needs WebGL 2, which this browser does not offer. It may be switched off in the settings (“hardware acceleration”), or the graphics driver may be blocked.',
    )
  // Environments are half floats whose mip levels are rendered, and so is the picture before tone mapping.
  const canRenderHalf =
    context.getExtension('EXT_color_buffer_float') !== null ||
    context.getExtension('EXT_color_buffer_half_float') !== null
  if (!canRenderHalf)
    throw new UnsupportedError(
      'It needs floating-point render targets (EXT_color_buffer_float or EXT_color_buffer_half_float), which this graphics device does not offer.',
    )
  return context
}
