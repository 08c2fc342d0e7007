// The page as it is served: worker and simulator are files beside it.
import { page } from "./main";

void page({
  wasm: async () => {
    const answer = await fetch("basrelief.wasm");
    if (!answer.ok) throw new Error(`basrelief.wasm: ${answer.status} ${answer.statusText}`);
    return answer.arrayBuffer();
  },
  worker: () => new Worker("worker.js"),
});
