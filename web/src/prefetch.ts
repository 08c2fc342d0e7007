// Data of the server, fetched by the page while the simulator computes.
import { counted } from "./load";
import { PATIENCE, type Draft } from "./protocol";

/** Largest number of requests at a time. Two fill a line; browsers allow six. */
const MOST = 4;
/** Bytes of the length before each of several tiles. */
const LENGTH = 4;

/** A response for the simulator. */
export interface Received { address: string; status: number; tag: string }

export interface Access {
  /** Passes a response to the simulator. */
  received(response: Received, body: Uint8Array<ArrayBuffer>): Promise<unknown>;
  /** Reports the bytes of tiles since the last call of `settle`. */
  came(bytes: number): void;
}

export class Prefetch {
  #queue: string[] = [];
  #underWay = new Map<string, AbortController>();
  /** Ends with the last delivery. The simulator gets hashes before the tiles that they check. */
  #last: Promise<unknown> = Promise.resolve();
  #bytes = 0;

  constructor(private readonly access: Access) {}

  /** Returns the requests that are under way or queued. A question for a draft names them, so that its answer lists none of their tiles again. */
  pending(): string[] {
    return [...this.#underWay.keys(), ...this.#queue];
  }

  /** Returns the number of requests that are not answered. */
  get left(): number {
    return this.#queue.length + this.#underWay.size;
  }

  /** Fetches the data that a draft lacks, instead of earlier ones. */
  want({ missing, needed }: Pick<Draft, "missing" | "needed">, isFinal: boolean): void {
    // During a drag each view lasts for a moment, and the next one may need the same tiles.
    if (isFinal) this.#underWay.forEach((control, address) => needed.includes(address) || control.abort());
    // What has left the queue since the question is under way or here.
    this.#queue = [...needed.filter(address => this.#queue.includes(address)), ...missing];
    this.#start();
  }

  stop(): void {
    this.want({ missing: [], needed: [] }, true);
  }

  /** Starts to count at zero, because the simulator has counted the tiles. */
  settle(): void {
    this.#bytes = 0;
  }

  #start(): void {
    while (this.#queue.length > 0 && this.#underWay.size < MOST) void this.#fetch(this.#queue.shift()!);
  }

  async #fetch(address: string): Promise<void> {
    const control = new AbortController();
    this.#underWay.set(address, control);
    const [body, before] = [this.#load(address, control.signal), this.#last];
    const delivered = body.then(async ([response, bytes]) => {
      await before;
      // The question is queued at once, so that the next draft finds the tiles.
      void this.access.received(response, bytes).catch(() => undefined);
    });
    this.#last = delivered.catch(() => undefined);
    // Without a response, the simulator requests the data itself, and reports the failure.
    await this.#last.then(() => this.#underWay.delete(address));
    if (await body.then(() => false, () => !control.signal.aborted)) this.#queue = [];
    this.#start();
  }

  async #load(address: string, signal: AbortSignal): Promise<[Received, Uint8Array<ArrayBuffer>]> {
    let bytes = 0;
    const add = (more: number) => {
      if (!address.startsWith("tile/")) return;
      bytes += more;
      this.access.came((this.#bytes += more));
    };
    try {
      const answer = await fetch(address, { signal: AbortSignal.any([signal, AbortSignal.timeout(PATIENCE)]) });
      const body = await new Response(counted(answer.body!, add)).arrayBuffer();
      const tiles = address.split(",").length;
      if (tiles > 1) add(-LENGTH * tiles);
      return [{ address, status: answer.status, tag: answer.headers.get("etag") ?? "" }, new Uint8Array(body)];
    } catch (error) {
      add(-bytes);
      throw error;
    }
  }
}
