// The simulator as WebAssembly: three functions and a memory, and three that it calls (crates/web/src/abi.rs). For the worker, and for
// node.
import { pack, unpack, type Parcel, type Sketch } from "./protocol";

interface Exports {
  memory: WebAssembly.Memory;
  inbox(length: number): number;
  answer(): number;
  outbox(): number;
}

export type Simulator = (json: unknown, rest?: Uint8Array) => Parcel;

/** What the simulator asks for while it answers. */
export interface Outside {
  /** Gets what is at an address, as `{ status, tag }` with the body behind it, or as `{ error }`; `fresh`: not what is kept. */
  get(address: string, fresh: boolean): Parcel;
  /** Shows a picture that a better one follows. */
  show(picture: Parcel<Sketch>): void;
}

const nobody: Outside = {
  get: () => ({ json: { error: "there is no server to ask" }, rest: new Uint8Array() }),
  show: () => undefined,
};

export async function simulator(wasm: BufferSource, outside = nobody): Promise<Simulator> {
  let answer: Uint8Array = new Uint8Array();
  // A view of the memory holds until the memory grows.
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
  const { instance } = await WebAssembly.instantiate(wasm, { page });
  const exports = instance.exports as unknown as Exports;
  return (json, rest = new Uint8Array()) => {
    const question = pack(json, rest);
    const at = exports.inbox(question.length);
    bytes(at, question.length).set(question);
    const length = exports.answer();
    // A copy: the memory is the simulator's, and may move.
    return unpack(bytes(exports.outbox(), length).slice());
  };
}
