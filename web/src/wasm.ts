// The simulator as WebAssembly: three functions and a memory (crates/web/src/abi.rs). For the worker, and for node.
import { pack, unpack, type Parcel } from "./protocol";

interface Exports {
  memory: WebAssembly.Memory;
  inbox(length: number): number;
  answer(): number;
  outbox(): number;
}

export type Simulator = (json: unknown, rest?: Uint8Array) => Parcel;

export async function simulator(wasm: BufferSource): Promise<Simulator> {
  const { instance } = await WebAssembly.instantiate(wasm, {});
  const exports = instance.exports as unknown as Exports;
  return (json, rest = new Uint8Array()) => {
    const question = pack(json, rest);
    const at = exports.inbox(question.length);
    new Uint8Array(exports.memory.buffer, at, question.length).set(question);
    const length = exports.answer();
    // A copy: the memory is the simulator's, and may move.
    return unpack(new Uint8Array(exports.memory.buffer, exports.outbox(), length).slice());
  };
}
