// Entry point of the page as one file, which contains the worker and the simulator.
import { page } from "./main";

/** Inserted by the build: the text of the worker, and the simulator compressed with gzip in base64. */
declare const WORKER: string;
declare const SIMULATOR: string;

void page({
  wasm: async () => {
    const bytes = Uint8Array.from(atob(SIMULATOR), c => c.charCodeAt(0));
    return new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  },
  worker: () => new Worker(URL.createObjectURL(new Blob([WORKER], { type: "text/javascript" }))),
});
