// The history of the page: one entry for each finished change, for Back, Forward, undo and redo.
import { byId } from "./dom";

/** Changes of one kind within this time share an entry \[ms\], for example those of a key that is held. */
const TOGETHER = 700;

export class Steps {
  #at: number;
  #last: number;
  /** Kind and time of the last change, and whether it is finished. */
  #kind = "";
  #time = 0;
  #rests = true;

  constructor() {
    this.#at = this.#last = (history.state as { at?: number } | null)?.at ?? 0;
    this.replace(location.hash);
  }

  /** Writes the address after a change. A change that goes on replaces its own entry. */
  write(address: string, kind: string, rests: boolean): void {
    const goesOn = kind === this.#kind && (!this.#rests || performance.now() - this.#time < TOGETHER);
    [this.#kind, this.#time, this.#rests] = [kind, performance.now(), rests];
    if (goesOn || address === location.hash) return this.replace(address);
    this.#last = ++this.#at;
    history.pushState({ at: this.#at }, "", address);
    this.#show();
  }

  /** Writes the address of the current entry. */
  replace(address: string): void {
    history.replaceState({ at: this.#at }, "", address || location.href);
    this.#show();
  }

  /** Notes a move in the history. Returns false if the user typed a new address. */
  moved({ state }: PopStateEvent): boolean {
    const { at } = (state ?? {}) as { at?: number };
    this.#kind = "";
    if (at === undefined) this.#last = ++this.#at;
    else this.#at = at;
    if (at === undefined) this.replace(location.hash);
    this.#show();
    return at !== undefined;
  }

  #show(): void {
    byId<HTMLButtonElement>("undo").disabled = this.#at === 0;
    byId<HTMLButtonElement>("redo").disabled = this.#at === this.#last;
  }
}
