// Entry point of the served page. The worker and the simulator are separate files next to the page.
import { page } from "./main";

void page({
  wasm: async () => {
    const answer = await fetch("basrelief.wasm");
    if (!answer.ok) throw new Error(`basrelief.wasm: ${answer.status} ${answer.statusText}`);
    return answer.arrayBuffer();
  },
  worker: () => new Worker("worker.js"),
});
