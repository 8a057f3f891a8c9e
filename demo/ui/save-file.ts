/** How long a browser may take to begin saving, ms: then what is saved is its own. */
const BEGUN = 10_000

/** Has the browser save a file under that name. */
export function saveFile(content: Blob, name: string): void {
  const link = document.createElement('a')
  link.href = URL.createObjectURL(content)
  link.download = name
  link.click()
  setTimeout(() => {
    URL.revokeObjectURL(link.href)
  }, BEGUN)
}
