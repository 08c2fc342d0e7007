// The start of the page: the simulator arrives with its progress, and a service worker keeps it for the next visit.
import { byId, thousands } from "./dom";

/** Inserted by the build: the size of the simulator \[bytes\]. */
declare const SIMULATOR_BYTES: number;

/** Compiles the simulator while its bytes arrive. */
export async function compiled(source: Promise<ReadableStream<Uint8Array>>): Promise<WebAssembly.Module> {
  const [bar, says] = [byId<HTMLProgressElement>("loading"), byId("answered")];
  bar.max = SIMULATOR_BYTES;
  let bytes = 0;
  const tell = () => {
    bar.value = bytes;
    says.textContent = `loading the simulator: ${thousands(bytes)} of ${thousands(SIMULATOR_BYTES)} bytes`;
  };
  tell();
  const counted = new TransformStream<Uint8Array, Uint8Array>({
    transform(chunk, next) {
      bytes += chunk.length;
      tell();
      next.enqueue(chunk);
    },
  });
  const body = (await source).pipeThrough(counted);
  return WebAssembly.compileStreaming(new Response(body, { headers: { "content-type": "application/wasm" } }));
}

/** Keeps the simulator in this browser. Browsers allow this over https and on this computer only. */
export function keep(): void {
  // Without a service worker the page works as well, and loads the simulator from the server.
  if (isSecureContext) navigator.serviceWorker?.register("worker.js").catch(() => undefined);
}
