// The timeline: the activity of each unit over time, in columns of equal width, with zoom and pan.
import { bytesAt } from "./client";
import { frameCycles } from "./changes";
import { drawing, el, thousands } from "./dom";
import type { Run, Step } from "./protocol";

/** In the order of the bytes of a column, from the bottom up. */
const STATES = ["busy", "memory", "starved", "blocked"] as const;
const NAMES = ["busy", "waiting for memory", "starved", "blocked"];
const HEIGHT = 28;
/** Smallest number of visible cycles. */
const LEAST = 16;
/** Largest number of visible cycles that are drawn one by one. The simulator lists the steps of twice as many. */
const SINGLE = 2048;
/** Delay before the steps are requested [ms]: long enough not to request them between two movements. */
const REST = 150;
/** Width of a drawing of single cycles [pixels]. */
const WIDTH = 1024;

/** The visible part of the run, which later runs keep: start, and length of 1. */
let [start, length] = [0, 1];

/** Returns the steps and waits of all units in these cycles. */
export type Steps = (from: number, to: number) => Promise<Step[]>;

interface Strip { name: string; bytes: Uint8Array; canvas: HTMLCanvasElement }

/** Listed steps of a run, by unit. */
interface Listed { from: number; to: number; steps: Step[][] }

const listed = new WeakMap<Run, Listed>();
let pending: ReturnType<typeof setTimeout> | undefined;

export function timeline(into: HTMLElement, run: Run, rest: Uint8Array, steps: Steps): void {
  const { report, strips } = run;
  if (!strips || strips.units.length === 0) {
    return into.replaceChildren(el("p", { class: "quiet" }, "The timeline appears when the image is idle."));
  }
  // Keeps the focus on its control when an answer arrives.
  const held = into.contains(document.activeElement) ? document.activeElement!.id : "";
  // After the last frame memory takes its last pixels.
  const drawn = Math.ceil(frameCycles(report) / strips.width);
  const total = strips.width * Math.max(1, Math.min(drawn, Math.max(...strips.units.map(({ at }) => at[1] / STATES.length))));
  const says = el("p", { class: "quiet", "aria-live": "off" }, "Point at a strip to see its values.");
  const all: Strip[] = strips.units.map(({ name, at }) => {
    return { name, bytes: bytesAt(rest, at), canvas: el("canvas", { height: HEIGHT, role: "img", "aria-label": `timeline of ${name}` }) };
  });
  const caption = el("caption", { id: "shown-cycles", "aria-live": "polite" });
  const ends = el("td");
  const show = () => {
    const [from, to, unit] = visible(total, strips.width);
    const each = unit === 1 ? "each step by itself" : `${thousands(unit)} per column`;
    caption.textContent = `Cycles ${thousands(from)} to ${thousands(to)}, ${each}`;
    ends.replaceChildren(frameEnds(report.cycles?.frames ?? [], from, to));
    const known = listedIn(run, from, to);
    all.forEach((strip, n) => (known && unit === 1 ? drawSteps(strip, known[n] ?? [], from, to) : draw(strip, from, to, unit, strips.width)));
    clearTimeout(pending);
    if (unit === 1 && !known) pending = setTimeout(() => void list(from, to).catch(error => (says.textContent = error.message)), REST);
  };
  const list = async (from: number, to: number) => {
    const margin = Math.floor((to - from) / 2);
    [from, to] = [Math.max(0, from - margin), Math.min(total, to + margin)];
    const found = await steps(from, to);
    listed.set(run, { from, to, steps: all.map((_, n) => found.filter(([unit]) => unit === n)) });
    document.documentElement.dataset["steps"] = `${from} ${to}`;
    if (caption.isConnected) show();
  };
  const zoom = (factor: number, at = 0.5) => {
    const next = Math.min(1, Math.max(Math.min(1, LEAST / total), length / factor));
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
  const rows = all.map((strip, n) => {
    const numeral = report.units?.[strip.name]?.numeral;
    point(strip.canvas, { zoom, pan, at: share => {
      const [from, to, unit] = visible(total, strips.width);
      const cycle = Math.min(to - 1, Math.floor(from + share * (to - from)));
      const step = unit === 1 ? listedIn(run, from, to)?.[n]?.find(([, first, end]) => first <= cycle && cycle < end) : undefined;
      says.textContent = `${strip.name}, ${step ? stepText(step) : told(strip.bytes, Math.floor(cycle / strips.width), strips.width)}`;
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
    id: "time-strips", class: "wide", tabindex: 0, role: "group", "aria-label": "Timeline: + and - zoom, arrow keys move", onkeydown: event => {
      const act = keys[(event as KeyboardEvent).key];
      if (!act) return;
      event.preventDefault();
      act();
    },
  }, table);
  const hint = el("p", { class: "quiet hint" }, "Zoom: + and \u2212, or Ctrl and wheel. Move: drag, or arrow keys. All: Home. "
    + `Up to ${thousands(SINGLE)} cycles show each step, with its arguments under the pointer.`);
  into.replaceChildren(el("ul", { class: "legend" }, ...STATES.map(swatch)), el("div", { class: "row" }, ...row), shown, says, hint);
  show();
  if (held) document.getElementById(held)?.focus();
}

/** Returns the visible cycles, and the cycles of a column of the drawing. */
function visible(total: number, width: number): [from: number, to: number, unit: number] {
  start = Math.min(1 - length, Math.max(0, start));
  const unit = length * total > SINGLE ? width : 1;
  const [count, last] = [Math.max(1, Math.round((length * total) / unit)), total / unit];
  const from = Math.min(last - count, Math.round((start * total) / unit));
  return [from * unit, (from + count) * unit, unit];
}

/** Returns the steps of a run if they are listed for these cycles. */
function listedIn(run: Run, from: number, to: number): Step[][] | undefined {
  const known = listed.get(run);
  return known && known.from <= from && to <= known.to ? known.steps : undefined;
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

function stepText([, from, to, , text]: Step): string {
  return `cycles ${thousands(from)} to ${thousands(to)}: ${text}`;
}

function coloured(canvas: HTMLCanvasElement): [CanvasRenderingContext2D, Record<string, string>] {
  const style = getComputedStyle(canvas);
  return [canvas.getContext("2d")!, Object.fromEntries(STATES.map(state => [state, style.getPropertyValue(`--${state}`)]))];
}

/** Draws the shares of the states in columns of `unit` cycles, from bytes for columns of `width` cycles. */
function draw({ canvas, bytes }: Strip, from: number, to: number, unit: number, width: number): void {
  canvas.width = (to - from) / unit;
  const [context, colours] = coloured(canvas);
  for (let x = 0; x < canvas.width; x++) {
    const column = Math.floor((from + x * unit) / width);
    let below = HEIGHT;
    STATES.forEach((state, n) => {
      const tall = (HEIGHT * (bytes[STATES.length * column + n] ?? 0)) / 255;
      context.fillStyle = colours[state]!;
      context.fillRect(x, below - tall, 1, tall);
      below -= tall;
    });
  }
}

/** Draws single steps, with a gap before each where there is room. */
function drawSteps({ canvas }: Strip, steps: Step[], from: number, to: number): void {
  const scale = Math.max(1, Math.floor(WIDTH / (to - from)));
  canvas.width = (to - from) * scale;
  const [context, colours] = coloured(canvas);
  const gap = scale >= 4 ? 1 : 0;
  for (const [, first, end, kind] of steps) {
    context.fillStyle = colours[kind] ?? "transparent";
    context.fillRect((first - from) * scale + gap, 0, (end - first) * scale - gap, HEIGHT);
  }
}
