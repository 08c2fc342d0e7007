// Views of a server's scene. The simulator draws them at once with the tiles that are here, and the page fetches the others.
import type { Answered } from "./client";
import { byId } from "./dom";
import { Prefetch } from "./prefetch";
import type { Draft, Told } from "./protocol";

/** Shortest time between two drafts [ms]. A draft is drawn at most a fifth of the time. */
const PAUSE = 250;
const SHARE = 4;
/** Time between two looks at the requests [ms]. */
const LOOK = 20;

export interface Access {
  ask<T>(question: Record<string, unknown>, body?: Uint8Array<ArrayBuffer>): Promise<Answered<T>>;
  came(bytes: number): void;
  show(draft: Draft, rest: Uint8Array): void;
}

export class Drafts {
  #prefetch: Prefetch;
  /** The reason for a stop by the user. */
  #stopped: string | undefined;

  constructor(private readonly access: Access) {
    this.#prefetch = new Prefetch({
      received: (response, body) => access.ask({ ask: "received", ...response }, body),
      came: bytes => access.came(bytes),
    });
  }

  /** Cancels all requests, and the question that waits for them. */
  stop(why: string): void {
    this.#stopped = why;
    this.#prefetch.stop();
  }

  /** Cancels all requests for a simulator that is no more. */
  forget(): void {
    this.#prefetch.stop();
  }

  /** The simulator has counted all tiles. */
  settle(): void {
    this.#prefetch.settle();
  }

  /** Returns the answer to a run if all tiles are here. Otherwise shows a draft, and fetches the tiles during a movement. */
  async now(question: Record<string, unknown>, isMoving: boolean): Promise<Answered<Told> | undefined> {
    const answer = await this.#ask(question);
    if (isWhole(answer)) return answer;
    this.access.show(answer.json, answer.rest);
    // At rest the picture in full size follows, which needs other tiles.
    if (isMoving) this.#prefetch.want(answer.json, false);
    return undefined;
  }

  /** Fetches all tiles of a run and returns its answer. Meanwhile shows drafts, unless `hides`. Returns nothing once `stale`. */
  async whole(question: Record<string, unknown>, hides: boolean, stale: () => boolean): Promise<Answered<Told> | undefined> {
    this.#stopped = undefined;
    try {
      return await this.#whole(question, hides, stale);
    } finally {
      byId("loading").hidden = true;
    }
  }

  async #whole(question: Record<string, unknown>, hides: boolean, stale: () => boolean): Promise<Answered<Told> | undefined> {
    const isOver = () => {
      if (this.#stopped) throw new Error(this.#stopped);
      return stale();
    };
    let all = 0;
    let waited = 0;
    for (let left = 1; left > 0;) {
      const began = performance.now();
      const answer = await this.#ask(question);
      if (isWhole(answer)) return waiting(answer, waited);
      if (isOver()) return undefined;
      if (!hides) this.access.show(answer.json, answer.rest);
      this.#prefetch.want(answer.json, true);
      all ||= this.#prefetch.left;
      const now = performance.now();
      const next = now + Math.max(PAUSE, SHARE * (now - began));
      do {
        loading(left = this.#prefetch.left, all);
        await new Promise(done => setTimeout(done, LOOK));
        if (isOver()) return undefined;
        left = this.#prefetch.left;
      } while (left > 0 && (hides || performance.now() < next));
      waited += performance.now() - now;
    }
    // What is still missing has failed or has no room. The simulator requests it itself and reports a failure.
    return waiting(await this.access.ask<Told>(question), waited);
  }

  #ask(question: Record<string, unknown>): Promise<Answered<Told> | Answered<Draft>> {
    const draft = this.#prefetch.pending();
    return this.access.ask({ ...question, draft }) as Promise<Answered<Told> | Answered<Draft>>;
  }
}

function isWhole(answer: Answered<Told> | Answered<Draft>): answer is Answered<Told> {
  return !("missing" in answer.json);
}

function waiting(answer: Answered<Told>, waited: number): Answered<Told> {
  return { ...answer, ms: answer.ms + waited, waited: answer.waited + waited };
}

/** Shows how many requests are answered. */
function loading(left: number, all: number): void {
  const bar = byId<HTMLProgressElement>("loading");
  [bar.hidden, bar.max, bar.value, bar.ariaLabel] = [left === 0, all, all - left, "Loading tiles"];
  // A screen reader reads each change.
  const [says, text] = [byId("answered"), `loading tiles: ${all - left} of ${all} requests`];
  if (says.textContent !== text) says.textContent = text;
}
