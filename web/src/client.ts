// The page's side of the worker.
import type { Answer, Lost, Meanwhile, Parcel, Place, Start, Took } from "./protocol";

export type Answered<T> = Parcel<T> & Took;

interface Waiting { resolve(answer: Answered<unknown>): void; reject(error: Error): void; meanwhile?: (told: Meanwhile) => void }

export class Client {
  /** Starts with the first question after a restart. Without a server there is none, so a start that fails is not repeated at once. */
  #worker: Worker | undefined;
  #asked = new Map<number, Waiting>();
  #next = 0;
  /** Number of restarts of the simulator. Each restart forgets the input. */
  starts = 0;

  constructor(private readonly start: () => Worker, private readonly wasm: WebAssembly.Module) {}

  #begin(): Worker {
    const worker = this.start();
    const message: Start = { wasm: this.wasm };
    worker.postMessage(message);
    worker.onmessage = (event: MessageEvent<Answer | Lost | Meanwhile>) => {
      if ("lost" in event.data) return this.restart(`The simulator stopped: ${event.data.lost}`);
      if (!("ms" in event.data)) return this.#asked.get(event.data.id)?.meanwhile?.(event.data);
      const { id, ...answered } = event.data;
      this.#asked.get(id)?.resolve(answered);
      this.#asked.delete(id);
    };
    // An event without a message: its file cannot be loaded.
    worker.onerror = event => this.restart(event.message ?? "The simulator cannot start: the server of this page does not answer.");
    return worker;
  }

  /** Cancels all questions and restarts the simulator, which loses its state. */
  restart(why: string): void {
    this.#worker?.terminate();
    this.#worker = undefined;
    this.starts++;
    const asked = [...this.#asked.values()];
    this.#asked.clear();
    asked.forEach(({ reject }) => reject(new Error(why)));
  }

  /** Sends a question. An invalid question rejects the promise. `meanwhile` receives the progress before the answer. */
  async ask<T>(json: unknown, rest = new Uint8Array(), meanwhile?: (told: Meanwhile) => void): Promise<Answered<T>> {
    const id = this.#next++;
    const answer = await new Promise<Answered<unknown>>((resolve, reject) => {
      this.#asked.set(id, { resolve, reject, ...(meanwhile && { meanwhile }) });
      (this.#worker ??= this.#begin()).postMessage({ id, json, rest });
    });
    const { error } = answer.json as { error?: string };
    if (error !== undefined) throw new Error(error);
    return answer as Answered<T>;
  }
}

export function bytesAt(rest: Uint8Array, [place, length]: Place): Uint8Array {
  return rest.subarray(place, place + length);
}
