// The service worker: answers with the kept simulator, and fetches it at the first visit. All other files come from the server.

/** Inserted by the build: a name of the simulator's content. */
declare const SIMULATOR_NAME: string;

const scope = self as unknown as ServiceWorkerGlobalScope;
const SIMULATOR = "basrelief.wasm";

/** Returns the simulator with this address, and replaces simulators of other builds. */
async function kept(request: Request): Promise<Response> {
  const cache = await caches.open(SIMULATOR);
  const found = await cache.match(request);
  if (found) return found;
  const answer = await fetch(request);
  if (answer.ok) {
    await Promise.all((await cache.keys()).map(old => cache.delete(old)));
    // A browser without room for it loads it again.
    await cache.put(request, answer.clone()).catch(() => undefined);
  }
  return answer;
}

/** Installs the handlers. The page that is open already is served, too. */
export function serve(): void {
  scope.addEventListener("install", event => {
    void scope.skipWaiting();
    event.waitUntil(kept(new Request(`${SIMULATOR}?${SIMULATOR_NAME}`)));
  });
  scope.addEventListener("activate", event => event.waitUntil(scope.clients.claim()));
  scope.addEventListener("fetch", event => {
    if (new URL(event.request.url).pathname.endsWith(`/${SIMULATOR}`)) event.respondWith(kept(event.request));
  });
}
