// The worker: one simulator, one question at a time.
import type { Answer, Lost, Question, Start } from "./protocol";
import { simulator, type Simulator } from "./wasm";

const scope = self as unknown as DedicatedWorkerGlobalScope;
let started: Promise<Simulator> | undefined;

scope.onmessage = async (event: MessageEvent<Start | Question>) => {
  const message = event.data;
  if ("wasm" in message) {
    started = simulator(message.wasm);
    return;
  }
  try {
    const ask = await started!;
    const began = performance.now();
    const { json, rest } = ask(message.json, message.rest);
    const answer: Answer = { id: message.id, json, rest, ms: performance.now() - began };
    scope.postMessage(answer, [rest.buffer]);
  } catch (error) {
    // WebAssembly that has trapped is not to be used again.
    const lost: Lost = { lost: String(error) };
    scope.postMessage(lost);
  }
};
