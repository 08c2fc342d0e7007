// Messages between the page and the simulator: JSON followed by bytes (crates/web/src/message.rs).

/** Offset and length of bytes after the JSON. */
export type Place = [number, number];

export interface Parcel<T = unknown> {
  json: T;
  rest: Uint8Array;
}

/** A question to the worker, and its answer. */
export interface Question { id: number; json: unknown; rest: Uint8Array }
/** Total time of the answer, and the part spent waiting for a server \[ms\]. */
export interface Took { ms: number; waited: number }
export interface Answer extends Took { id: number; json: unknown; rest: Uint8Array }
/** First message to the worker: its simulator. */
export interface Start { wasm: WebAssembly.Module }
/** Progress of a question: a count of bytes received from a server, or an intermediate picture. */
export type Meanwhile = { id: number; came: number } | { id: number; sketch: Sketch; rest: Uint8Array };
export interface Sketch { at: Place; width: number; height: number }
/** The simulator stopped during a question. No answer follows. */
export interface Lost { lost: string }

export type Takes =
  | { kind: "switch" } | { kind: "text" }
  | { kind: "choice"; choices: { name: string; about: string }[] }
  | { kind: "integer" | "number"; min: number; max: number };

export interface Parameter {
  key: string; value: unknown; default: unknown; unit: string; range: string; takes: Takes;
  about: string; effect: "work" | "timing" | "cost"; provenance: { kind: string; text: string };
}

export interface Machine {
  name: string; fetches: boolean; about: string; demos: string[]; main: string[];
  units: { name: string; numeral: string; role: string }[]; parameters: Parameter[];
}

export interface Catalogue { version: string; machines: Machine[]; demos: { name: string; about: string; machine: string }[] }

/** Description of a model, of a demo or of a server's scene. */
export interface Taken { machine: string; scene: boolean; triangles?: number; warnings?: string[] }

export interface PictureInfo { name: string; about: string; at: Place; width: number; height: number }

export interface Unit {
  busy: number; done: number; numeral?: number;
  starved: Record<string, number>; blocked: Record<string, number>; memory: Record<string, number>;
}

/** The fields of report.json that the page itself reads. The simulator's own markup shows the whole report. */
export interface Report {
  machine: string;
  input: { name: string; sha256: string };
  outcome: { kind: string; message?: string };
  size: { width: number; height: number };
  config: Record<string, unknown>;
  cycles?: { total: number; write_tail: number; frames: number[] };
  units?: Record<string, Unit>;
  bytes?: { requested: number; moved: number };
  hardware: { area_ge: number }[];
  /** Of the last frame, of the worst one, and of each frame if there are several. */
  quality?: { psnr_db: number; ssim: number; flip: number; min: { psnr_db: number }; frames?: unknown[] };
  image: { sha256: string }[];
  derived: Record<string, { value: number; unit: string }>;
  figures: Record<string, number>;
  warnings: string[];
}

/** The answer to a run, in wire format. */
export type Told = Omit<Run, "report" | "text"> & { report: Place };

export interface Run {
  report: Report;
  /** The report as the command line writes it, without the figures of the host. */
  text: string;
  command: string;
  sections: { id: string; title: string; html: string }[];
  pictures: PictureInfo[];
  path: Come | null;
  strips: { width: number; units: { name: string; at: Place }[] } | null;
}

/** Answer to a run that lacks tiles: a picture without them, the addresses to be fetched in this order, and those of the addresses
 *  under way that are still needed. */
export interface Draft { draft: Sketch | null; missing: string[]; needed: string[] }

/** Timeout for a server's answer [ms]. */
export const PATIENCE = 60_000;

/** Totals received from the server so far. */
export interface Come { requests: number; scene_bytes: number; tiles: number; tile_bytes: number }

/** Answer to `steps`: number of the unit, first cycle, end, kind, and the state with its arguments. */
export type Step = [unit: number, from: number, to: number, kind: string, text: string];

/** Cost of a pixel. */
export interface Pixel {
  cycles: number;
  ways: { unit: string; kind: "busy" | "memory" | "starved" | "blocked"; of: string; cycles: number }[];
  overdraw: number; level: number | null; entry: number | null;
  polygon: { polygon: number; object: number | null; frame: number } | null;
}

export interface View {
  size: [number, number];
  turn?: [number, number]; zoom?: number; light?: [number, number, number]; frames?: number; orbit?: number;
}

const LENGTH = 4;

export function pack(json: unknown, rest: Uint8Array): Uint8Array {
  const text = new TextEncoder().encode(JSON.stringify(json));
  const bytes = new Uint8Array(LENGTH + text.length + rest.length);
  new DataView(bytes.buffer).setUint32(0, text.length, true);
  bytes.set(text, LENGTH);
  bytes.set(rest, LENGTH + text.length);
  return bytes;
}

export function unpack(bytes: Uint8Array): Parcel {
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true);
  const json: unknown = JSON.parse(new TextDecoder().decode(bytes.slice(LENGTH, LENGTH + length)));
  return { json, rest: bytes.slice(LENGTH + length) };
}

/** A cause of the difference between two runs, with its effect alone; null if it cannot be measured. */
export interface Cause { cause: string; by: number | null }

/** Answer to `explain`: the words of `basrelief compare`, and the causes. */
export interface Explained { text: string; causes: Cause[] }
