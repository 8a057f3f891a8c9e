/** As in style/page.css: from this width on, the panel stands beside the view. */
const WIDE = '(min-width: 820px)'

/** Keeps the panel open where there is room for it; elsewhere it is a sheet that begins closed. */
export function keepSheet(sheet: HTMLDetailsElement): void {
  const wide = matchMedia(WIDE)
  const follow = (): void => {
    sheet.open = wide.matches
  }
  wide.addEventListener('change', follow)
  follow()
}
