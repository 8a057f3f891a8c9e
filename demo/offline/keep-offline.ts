/** Keeps the page for times without a network, unless its user asks to save data or the browser cannot. */
export function keepOffline(): void {
  // What is served while it is being written changes too often to be kept.
  if (!import.meta.env.PROD || !('serviceWorker' in navigator)) return
  const connection = (navigator as { connection?: { saveData?: boolean } }).connection
  if (connection?.saveData === true) return
  navigator.serviceWorker
    .register(`${import.meta.env.BASE_URL}service-worker.js`)
    .catch((error: unknown) => {
      // The page works as before, but for the next time without a network.
      console.info(error)
    })
}
