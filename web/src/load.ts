// The start of the page: the simulator arrives with its progress, and a service worker keeps it for the next visit.
import { byId, thousands } from "./dom";

/** Inserted by the build: the size of the simulator \[bytes\]. */
declare const SIMULATOR_BYTES: number;

/** Reports the length of each chunk of a stream. */
export function counted(stream: ReadableStream<Uint8Array>, told: (bytes: number) => void): ReadableStream<Uint8Array> {
  return stream.pipeThrough(new TransformStream<Uint8Array, Uint8Array>({
    transform(chunk, next) {
      told(chunk.length);
      next.enqueue(chunk);
    },
  }));
}

/** Compiles the simulator while its bytes arrive. */
export async function compiled(source: Promise<ReadableStream<Uint8Array>>): Promise<WebAssembly.Module> {
  const [bar, says] = [byId<HTMLProgressElement>("loading"), byId("answered")];
  bar.max = SIMULATOR_BYTES;
  let bytes = 0;
  const tell = (more: number) => {
    bar.value = bytes += more;
    says.textContent = `loading the simulator: ${thousands(bytes)} of ${thousands(SIMULATOR_BYTES)} bytes`;
  };
  tell(0);
  const body = counted(await source, tell);
  return WebAssembly.compileStreaming(new Response(body, { headers: { "content-type": "application/wasm" } }));
}

/** Keeps the simulator in this browser. Browsers allow this over https and on this computer only. */
export function keep(): void {
  // Without a service worker the page works as well, and loads the simulator from the server.
  if (isSecureContext) navigator.serviceWorker?.register("worker.js").catch(() => undefined);
}
