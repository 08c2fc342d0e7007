// The time line: the activity of each unit over time, in columns of equal width, with zoom and pan.
import { bytesAt } from "./client";
import { frameCycles } from "./changes";
import { drawing, el, thousands } from "./dom";
import type { Run } from "./protocol";

/** In the order of the bytes of a column, from the bottom up. */
const STATES = ["busy", "memory", "starved", "blocked"] as const;
const NAMES = ["busy", "waiting for memory", "starved", "blocked"];
const HEIGHT = 28;
/** Smallest number of visible columns. */
const LEAST = 8;

/** The visible part of the run, which later runs keep: start, and length of 1. */
let [start, length] = [0, 1];

interface Strip { name: string; bytes: Uint8Array; canvas: HTMLCanvasElement }

export function timeline(into: HTMLElement, { report, strips }: Run, rest: Uint8Array): void {
  if (!strips || strips.units.length === 0) {
    return into.replaceChildren(el("p", { class: "quiet" }, "The time line appears when the image is idle."));
  }
  // Keeps the focus on its control when an answer arrives.
  const held = into.contains(document.activeElement) ? document.activeElement!.id : "";
  // After the last frame memory takes its last pixels.
  const drawn = Math.ceil(frameCycles(report) / strips.width);
  const columns = Math.max(1, Math.min(drawn, Math.max(...strips.units.map(({ at }) => at[1] / STATES.length))));
  const says = el("p", { class: "quiet", "aria-live": "off" }, "Point at a strip to see its values.");
  const all: Strip[] = strips.units.map(({ name, at }) => {
    return { name, bytes: bytesAt(rest, at), canvas: el("canvas", { height: HEIGHT, role: "img", "aria-label": `time line of ${name}` }) };
  });
  const caption = el("caption", { id: "shown-cycles", "aria-live": "polite" });
  const ends = el("td");
  const show = () => {
    const [from, to] = visible(columns);
    caption.textContent = `Cycles ${thousands(from * strips.width)} to ${thousands(to * strips.width)}, ${thousands(strips.width)} per column`;
    ends.replaceChildren(frameEnds(report.cycles?.frames ?? [], from * strips.width, to * strips.width));
    all.forEach(strip => draw(strip, from, to));
  };
  const zoom = (factor: number, at = 0.5) => {
    const next = Math.min(1, Math.max(Math.min(1, LEAST / columns), length / factor));
    start += at * (length - next);
    length = next;
    show();
  };
  const pan = (by: number) => {
    start += by * length;
    show();
  };
  const keys: Record<string, () => void> = {
    "+": () => zoom(2), "-": () => zoom(0.5), ArrowLeft: () => pan(-0.25), ArrowRight: () => pan(0.25), Home: () => zoom(0),
  };
  const rows = all.map(strip => {
    const numeral = report.units?.[strip.name]?.numeral;
    point(strip.canvas, { zoom, pan, at: share => {
      const [from, to] = visible(columns);
      says.textContent = `${strip.name}, ${told(strip.bytes, Math.min(to - 1, Math.floor(from + share * (to - from))), strips.width)}`;
    } });
    const name = el("th", { scope: "row" }, strip.name, el("span", { class: "quiet" }, numeral === undefined ? "" : ` (${numeral})`));
    return el("tr", {}, name, el("td", {}, strip.canvas));
  });
  const frames = (report.cycles?.frames.length ?? 0) < 2 ? [] : [el("tr", {}, el("th", { scope: "row" }, "frames end"), ends)];
  const table = el("table", { class: "strips" }, caption, el("tbody", {}, ...frames, ...rows));
  const swatch = (state: string, n: number) => el("li", {}, el("span", { class: `swatch ${state}`, "aria-hidden": "true" }), NAMES[n]!);
  const buttons = Object.entries({ "Zoom in": "+", "Zoom out": "-", Earlier: "ArrowLeft", Later: "ArrowRight", All: "Home" });
  const row = buttons.map(([name, key]) => el("button", { type: "button", id: `time-${key}`, onclick: () => keys[key]!() }, name));
  const shown = el("div", {
    id: "time-strips", class: "wide", tabindex: 0, role: "group", "aria-label": "Time line: + and - zoom, arrow keys move", onkeydown: event => {
      const act = keys[(event as KeyboardEvent).key];
      if (!act) return;
      event.preventDefault();
      act();
    },
  }, table);
  const hint = el("p", { class: "quiet hint" }, "Zoom: + and \u2212, or Ctrl and wheel. Move: drag, or arrow keys. All: Home.");
  into.replaceChildren(el("ul", { class: "legend" }, ...STATES.map(swatch)), el("div", { class: "row" }, ...row), shown, says, hint);
  show();
  if (held) document.getElementById(held)?.focus();
}

/** Returns the first visible column and the one after the last. */
function visible(columns: number): [number, number] {
  start = Math.min(1 - length, Math.max(0, start));
  const count = Math.min(columns, Math.max(Math.min(LEAST, columns), Math.round(length * columns)));
  const from = Math.min(columns - count, Math.round(start * columns));
  return [from, from + count];
}

interface Pointing { zoom(factor: number, at: number): void; pan(by: number): void; at(share: number): void }

/** Lets the pointer show values, the drag pan and the wheel zoom. */
function point(canvas: HTMLCanvasElement, { zoom, pan, at }: Pointing): void {
  const share = (event: MouseEvent) => {
    const box = canvas.getBoundingClientRect();
    return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
  };
  let held: number | undefined;
  canvas.addEventListener("pointerdown", event => {
    canvas.setPointerCapture(event.pointerId);
    held = share(event);
  });
  canvas.addEventListener("pointermove", event => {
    const now = share(event);
    at(now);
    if (held === undefined || event.buttons === 0) return;
    pan(held - now);
    held = now;
  });
  canvas.addEventListener("pointerup", () => (held = undefined));
  canvas.addEventListener("wheel", event => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    zoom(event.deltaY < 0 ? 1.5 : 1 / 1.5, share(event));
  }, { passive: false });
}

/** Marks the ends of the frames. */
function frameEnds(cycles: number[], from: number, to: number): SVGElement {
  let at = 0;
  const ends = cycles.map(length => (at += length)).filter(end => end >= from && end <= to);
  return drawing("frames-axis", ends.map(end => ({ x: (1000 * (end - from)) / (to - from), y: 0, width: 1.5, height: 10 })));
}

function told(bytes: Uint8Array, column: number, width: number): string {
  const shares = STATES.map((_, state) => (bytes[STATES.length * column + state] ?? 0) / 255);
  const parts = shares.flatMap((share, state) => (share > 0 ? [`${NAMES[state]} ${(100 * share).toFixed(0)} %`] : []));
  return `cycles ${thousands(column * width)} to ${thousands((column + 1) * width)}: ${parts.join(", ") || "done"}`;
}

function draw({ canvas, bytes }: Strip, from: number, to: number): void {
  canvas.width = to - from;
  const style = getComputedStyle(canvas);
  const colours = STATES.map(state => style.getPropertyValue(`--${state}`));
  const context = canvas.getContext("2d")!;
  for (let column = from; column < Math.min(to, bytes.length / STATES.length); column++) {
    let below = HEIGHT;
    colours.forEach((colour, state) => {
      const tall = (HEIGHT * bytes[STATES.length * column + state]!) / 255;
      context.fillStyle = colour;
      context.fillRect(column - from, below - tall, 1, tall);
      below -= tall;
    });
  }
}
