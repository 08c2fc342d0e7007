// The time line: the activity of each unit over time, in columns of equal width.
import { bytesAt } from "./client";
import { frameCycles } from "./changes";
import { el, thousands } from "./dom";
import type { Run } from "./protocol";

/** In the order of the bytes of a column, from the bottom up. */
const STATES = ["busy", "memory", "starved", "blocked"] as const;
const NAMES = ["busy", "waiting for memory", "starved", "blocked"];
const HEIGHT = 28;

export function timeline({ report, strips }: Run, rest: Uint8Array): HTMLElement {
  if (!strips || strips.units.length === 0) return el("p", { class: "quiet" }, "The timeline appears when the image is idle.");
  // After the last frame memory takes its last pixels.
  const drawn = Math.ceil(frameCycles(report) / strips.width);
  const columns = Math.max(1, Math.min(drawn, ...strips.units.map(({ at }) => at[1] / STATES.length).sort((a, b) => b - a).slice(0, 1)));
  const says = el("p", { class: "quiet", "aria-live": "off" }, "Point at a strip to see its values.");
  const rows = strips.units.map(({ name, at }) => {
    const bytes = bytesAt(rest, at);
    const canvas = el("canvas", { width: columns, height: HEIGHT, role: "img", "aria-label": `time line of ${name}` });
    canvas.addEventListener("pointermove", event => {
      const box = canvas.getBoundingClientRect();
      const column = Math.min(columns - 1, Math.floor(((event.clientX - box.left) / box.width) * columns));
      says.textContent = `${name}, ${told(bytes, column, strips.width)}`;
    });
    queueMicrotask(() => draw(canvas, bytes));
    const numeral = report.units?.[name]?.numeral;
    return el("tr", {}, el("th", {}, name, el("span", { class: "quiet" }, numeral === undefined ? "" : ` (${numeral})`)), el("td", {}, canvas));
  });
  const ends = frames(report.cycles?.frames ?? [], strips.width * columns);
  const caption = `${thousands(columns)} columns of ${thousands(strips.width)} cycles each, to the end of the last frame`;
  const table = el("table", { class: "strips" }, el("caption", {}, caption), el("tbody", {}, ...ends, ...rows));
  const swatch = (state: string, n: number) => el("li", {}, el("span", { class: `swatch ${state}`, "aria-hidden": "true" }), NAMES[n]!);
  return el("div", {}, el("ul", { class: "legend" }, ...STATES.map(swatch)), table, says);
}

/** Marks the ends of the frames. */
function frames(cycles: number[], whole: number): HTMLElement[] {
  if (cycles.length < 2) return [];
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 1000 10");
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("class", "frames-axis");
  let at = 0;
  for (const length of cycles) {
    at += length;
    const line = document.createElementNS("http://www.w3.org/2000/svg", "rect");
    for (const [key, value] of Object.entries({ x: (1000 * at) / whole, y: 0, width: 1.5, height: 10 })) line.setAttribute(key, String(value));
    svg.append(line);
  }
  return [el("tr", {}, el("th", {}, "frames end"), el("td", {}, svg as unknown as Node))];
}

function told(bytes: Uint8Array, column: number, width: number): string {
  const shares = STATES.map((_, state) => (bytes[STATES.length * column + state] ?? 0) / 255);
  const parts = shares.flatMap((share, state) => (share > 0 ? [`${NAMES[state]} ${(100 * share).toFixed(0)} %`] : []));
  return `cycles ${thousands(column * width)} to ${thousands((column + 1) * width)}: ${parts.join(", ") || "done"}`;
}

function draw(canvas: HTMLCanvasElement, bytes: Uint8Array): void {
  const style = getComputedStyle(canvas);
  const colours = STATES.map(state => style.getPropertyValue(`--${state}`));
  const context = canvas.getContext("2d")!;
  context.clearRect(0, 0, canvas.width, canvas.height);
  for (let column = 0; column < bytes.length / STATES.length; column++) {
    let below = HEIGHT;
    colours.forEach((colour, state) => {
      const tall = (HEIGHT * bytes[STATES.length * column + state]!) / 255;
      context.fillStyle = colour;
      context.fillRect(column, below - tall, 1, tall);
      below -= tall;
    });
  }
}
