/** A labelled input that shows, and changes, some value of the page. */
export interface Control {
  element: HTMLElement
  /** Shows the value as it is now, or hides the control where it has no meaning. */
  refresh: () => void
}

/** Carries a change out and deals with its refusal. */
export type Attempt = (change: () => void) => void
