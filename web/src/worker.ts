// The worker: one simulator, which answers one question at a time. As a service worker, the same file keeps the simulator.
import { serve } from "./cache";
import type { Answer, Lost, Meanwhile, Question, Start } from "./protocol";
import { simulator, type Outside, type Simulator } from "./wasm";

/** Timeout for a server's answer \[ms\]. A synchronous request reports no progress. */
const PATIENCE = 60_000;

const scope = self as unknown as DedicatedWorkerGlobalScope;
let started: Promise<Simulator> | undefined;
/** Id of the current question. */
let id = 0;
/** Time spent waiting for the server during the current question \[ms\]. */
let waited = 0;

function tell(meanwhile: Meanwhile, lent: Transferable[] = []): void {
  scope.postMessage(meanwhile, lent);
}

const outside: Outside = {
  // Synchronous, because the simulator cannot continue without the answer. A worker may block. The request reports no progress.
  get(address, fresh) {
    const request = new XMLHttpRequest();
    const began = performance.now();
    try {
      request.open("GET", address, false);
      request.responseType = "arraybuffer";
      request.timeout = PATIENCE;
      if (fresh) request.setRequestHeader("cache-control", "no-cache");
      request.send();
    } catch {
      const error = performance.now() - began < PATIENCE ? "no connection to the server" : `no answer has come, within ${PATIENCE / 1000} s`;
      return { json: { error }, rest: new Uint8Array() };
    } finally {
      waited += performance.now() - began;
    }
    const rest = new Uint8Array(request.response as ArrayBuffer);
    // Answers count the bytes of tiles and not those of the lists that check them.
    if (!address.startsWith("hashes/")) tell({ id, came: rest.length });
    return { json: { status: request.status, tag: request.getResponseHeader("etag") ?? "" }, rest };
  },
  show: ({ json, rest }) => tell({ id, sketch: json, rest }, [rest.buffer]),
};

scope.onmessage = async (event: MessageEvent<Start | Question>) => {
  const message = event.data;
  if ("wasm" in message) {
    started = simulator(message.wasm, outside);
    return;
  }
  try {
    const ask = await started!;
    [id, waited] = [message.id, 0];
    const began = performance.now();
    const { json, rest } = ask(message.json, message.rest);
    const answer: Answer = { id, json, rest, ms: performance.now() - began, waited };
    scope.postMessage(answer, [rest.buffer]);
  } catch (error) {
    // A WebAssembly instance must not be used after a trap.
    const lost: Lost = { lost: String(error) };
    scope.postMessage(lost);
  }
};

if ("clients" in self) serve();
