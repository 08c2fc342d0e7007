// The simulator with its current input. A question about another input loads that input first.
import type { Answered, Client } from "./client";
import type { Dropped } from "./files";
import type { Meanwhile, Taken } from "./protocol";

/** An input of runs: a demo, dropped files, or the scene of the page's server. Equal inputs are the same object. */
export type Source = { demo: string } | { files: Dropped } | { server: string };

function question(source: Source): [unknown, Uint8Array<ArrayBuffer>?] {
  if ("demo" in source) return [{ ask: "demo", name: source.demo }];
  if ("server" in source) return [{ ask: "from", server: source.server }];
  const { name, files, rest } = source.files;
  return [{ ask: "files", name, files }, rest];
}

export class Session {
  #source: Source | undefined;
  /** The start of the simulator that loaded the input. */
  #start = 0;
  #last: Promise<unknown> = Promise.resolve();

  /** `loaded` is called after each load of an input. */
  constructor(private readonly client: Client, private readonly loaded: () => void) {}

  /** Loads an input. If that fails, the simulator keeps the former input. */
  load(source: Source): Promise<Taken> {
    return this.#alone(() => this.#load(source));
  }

  /** Asks about an input. */
  ask<T>(source: Source, json: unknown, meanwhile?: (told: Meanwhile) => void, rest?: Uint8Array<ArrayBuffer>): Promise<Answered<T>> {
    return this.#alone(async () => {
      if (source !== this.#source || this.client.starts !== this.#start) await this.#load(source);
      return this.client.ask<T>(json, rest, meanwhile);
    });
  }

  async #load(source: Source): Promise<Taken> {
    const { json } = await this.client.ask<Taken>(...question(source));
    [this.#source, this.#start] = [source, this.client.starts];
    this.loaded();
    return json;
  }

  /** Starts after all earlier work has ended, because an input and the questions about it belong together. */
  #alone<T>(act: () => Promise<T>): Promise<T> {
    const next = this.#last.then(act);
    this.#last = next.catch(() => undefined);
    return next;
  }
}
