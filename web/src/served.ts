// Entry point of the served page. The worker and the simulator are separate files next to the page.
import { keep } from "./load";
import { page } from "./main";

/** Inserted by the build: a name of the simulator's content. */
declare const SIMULATOR_NAME: string;

void page({
  wasm: async () => {
    // Another build has another address, so a cached simulator is never stale.
    const answer = await fetch(`basrelief.wasm?${SIMULATOR_NAME}`);
    if (!answer.ok) throw new Error(`basrelief.wasm: ${answer.status} ${answer.statusText}`);
    return answer.body!;
  },
  worker: () => new Worker("worker.js"),
}).then(keep);
