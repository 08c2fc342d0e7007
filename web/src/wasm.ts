// The simulator as WebAssembly: three exported functions, a memory, and three imported functions (crates/web/src/abi.rs). The
// worker and node use this module.
import { pack, unpack, type Parcel, type Sketch } from "./protocol";

interface Exports {
  memory: WebAssembly.Memory;
  inbox(length: number): number;
  answer(): number;
  outbox(): number;
}

export type Simulator = (json: unknown, rest?: Uint8Array) => Parcel;

/** Requests of the simulator while it computes an answer. */
export interface Outside {
  /** Fetches an address. Returns `{ status, tag }` followed by the body, or `{ error }`. `fresh` bypasses the browser cache. */
  get(address: string, fresh: boolean): Parcel;
  /** Shows an intermediate picture. */
  show(picture: Parcel<Sketch>): void;
}

const nobody: Outside = {
  get: () => ({ json: { error: "there is no server to ask" }, rest: new Uint8Array() }),
  show: () => undefined,
};

export async function simulator(wasm: WebAssembly.Module, outside = nobody): Promise<Simulator> {
  let answer: Uint8Array = new Uint8Array();
  // A view of the memory becomes invalid when the memory grows.
  const bytes = (at: number, length: number) => new Uint8Array(exports.memory.buffer, at, length);
  const page = {
    get(at: number, length: number, fresh: number): number {
      const { json, rest } = outside.get(new TextDecoder().decode(bytes(at, length).slice()), fresh !== 0);
      answer = pack(json, rest);
      return answer.length;
    },
    take: (at: number) => bytes(at, answer.length).set(answer),
    show: (at: number, length: number) => outside.show(unpack(bytes(at, length).slice()) as Parcel<Sketch>),
  };
  const instance = await WebAssembly.instantiate(wasm, { page });
  const exports = instance.exports as unknown as Exports;
  return (json, rest = new Uint8Array()) => {
    const question = pack(json, rest);
    const at = exports.inbox(question.length);
    bytes(at, question.length).set(question);
    const length = exports.answer();
    // Copies the bytes, because the memory belongs to the simulator and may move.
    return unpack(bytes(exports.outbox(), length).slice());
  };
}
