// Entry point of the page as one file, which contains the worker and the simulator.
import { page } from "./main";

/** Inserted by the build: the text of the worker, and the simulator compressed with gzip in base64. */
declare const WORKER: string;
declare const SIMULATOR: string;

void page({
  wasm: async () => {
    const bytes = Uint8Array.from(atob(SIMULATOR), c => c.charCodeAt(0));
    const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(unpacked).arrayBuffer();
  },
  worker: () => new Worker(URL.createObjectURL(new Blob([WORKER], { type: "text/javascript" }))),
});
