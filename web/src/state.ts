// The state of the page, as encoded in its address. A shared address repeats the run.
import type { View } from "./protocol";

export interface State {
  /** True if the server's scene is drawn. */
  served: boolean;
  demo: string | null;
  /** Name of the dropped file that is drawn. */
  file: string | null;
  machine: string | null;
  set: Map<string, string>;
  view: View;
  panel: string;
}

export const SIZES: [number, number][] = [[160, 120], [320, 240], [640, 480], [1280, 720], [1920, 1080]];

const FIRST_PANEL = "units";

/** Returns a copy that later changes of the state do not reach. */
export const copied = (state: State): State => ({ ...state, set: new Map(state.set), view: { ...state.view } });

export function initial(served: boolean): State {
  const common = { served, file: null, machine: null, view: { size: [640, 480] as [number, number] }, panel: FIRST_PANEL };
  // Shows intermediate pictures while tiles arrive.
  return served ? { ...common, demo: null, set: new Map([["defer.mode", "progressive"]]) } : { ...common, demo: "golf-ball", set: new Map() };
}

const numbers = (text: string | null): number[] => (text ?? "").split(",").map(Number);

function list<N extends number>(text: string | null, length: N): number[] | undefined {
  const all = numbers(text);
  return text !== null && all.length === length && all.every(Number.isFinite) ? all : undefined;
}

export function read(hash: string, served: boolean): State {
  const from = new URLSearchParams(hash.replace(/^#/, ""));
  const state = initial(served);
  if (from.size > 0) state.set = new Map();
  if (!served) state.file = from.get("file") || null;
  if (!served) state.demo = from.get("demo") ?? (state.file === null ? state.demo : null);
  state.machine = from.get("machine");
  state.panel = from.get("show") ?? state.panel;
  const size = from.get("size")?.split("x").map(Number);
  if (size?.length === 2 && size.every(side => Number.isInteger(side) && side > 0)) state.view.size = size as [number, number];
  const turn = list(from.get("turn"), 2);
  if (turn) state.view.turn = turn as [number, number];
  const light = list(from.get("light"), 3);
  if (light) state.view.light = light as [number, number, number];
  for (const key of ["zoom", "frames", "orbit"] as const) {
    const value = list(from.get(key), 1);
    if (value && (key !== "frames" || Number.isInteger(value[0]))) state.view[key] = value[0]!;
  }
  for (const setting of from.getAll("set")) {
    const at = setting.indexOf("=");
    if (at > 0) state.set.set(setting.slice(0, at), setting.slice(at + 1));
  }
  return state;
}

/** Returns the addresses of the pinned runs in an address. */
export const pinsIn = (hash: string): string[] => new URLSearchParams(hash.replace(/^#/, "")).getAll("pin");

/** Returns the address of a state, with the addresses of its pinned runs. */
export function write({ demo, file, machine, set, view, panel }: State, pins: string[] = []): string {
  const to = new URLSearchParams();
  if (demo !== null) to.set("demo", demo);
  else if (file !== null) to.set("file", file);
  if (machine !== null) to.set("machine", machine);
  to.set("size", view.size.join("x"));
  if (view.turn) to.set("turn", view.turn.join(","));
  if (view.light) to.set("light", view.light.join(","));
  for (const key of ["zoom", "frames", "orbit"] as const) if (view[key] !== undefined) to.set(key, String(view[key]));
  for (const [key, value] of set) to.append("set", `${key}=${value}`);
  if (panel !== FIRST_PANEL) to.set("show", panel);
  for (const pin of pins) to.append("pin", pin);
  return `#${to}`;
}
