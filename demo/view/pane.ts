/** An upright strip of the picture that is drawn in its own way. */
export interface Pane {
  /** Bounds, as shares of the picture's width. */
  left: number
  right: number
  /** Draws one of its frames by calling `render`. */
  draw: (render: () => void) => void
}

/** All of the picture, drawn as the scene is. */
export const WHOLE: Pane = {
  left: 0,
  right: 1,
  draw: (render) => {
    render()
  },
}
