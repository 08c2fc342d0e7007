// Differences between a run and the pinned run.
import { change, el, thousands } from "./dom";
import type { Report, Run, Unit } from "./protocol";

const sum = (of: Record<string, number>): number => Object.values(of).reduce((all, n) => all + n, 0);

export const frameCycles = ({ cycles }: Report): number => cycles?.frames.reduce((all, n) => all + n, 0) ?? 0;

export const memoryBytes = ({ bytes }: Report): number => bytes?.moved ?? 0;

const STATES: [string, string, (unit: Unit) => number][] = [
  ["busy", "busy", unit => unit.busy], ["memory", "memory", unit => sum(unit.memory)],
  ["starved", "starved", unit => sum(unit.starved)], ["blocked", "blocked", unit => sum(unit.blocked)],
];

function bar(unit: Unit | undefined, whole: number): SVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 1000 10");
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("class", "bar");
  let x = 0;
  for (const [state, , of] of unit ? STATES : []) {
    const width = (1000 * of(unit!)) / Math.max(1, whole);
    const part = document.createElementNS("http://www.w3.org/2000/svg", "rect");
    for (const [key, value] of Object.entries({ x, y: 0, width, height: 10, class: state })) part.setAttribute(key, String(value));
    svg.append(part);
    x += width;
  }
  return svg;
}

/** Lists the parameters with different values, from one run to the other. */
function settings(a: unknown, b: unknown, path = ""): [string, string, string][] {
  if (JSON.stringify(a) === JSON.stringify(b)) return [];
  const isGroup = (x: unknown): x is Record<string, unknown> => typeof x === "object" && x !== null && !Array.isArray(x);
  if (isGroup(a) && isGroup(b)) return Object.keys({ ...a, ...b }).flatMap(key => settings(a[key], b[key], path ? `${path}.${key}` : key));
  return [[path, JSON.stringify(a) ?? "", JSON.stringify(b) ?? ""]];
}

export function changes(pinned: Run | undefined, now: Run): HTMLElement {
  if (!pinned) return el("p", { class: "quiet" }, "Pin a run and change a parameter to see the changes of each unit here.");
  const [a, b] = [pinned.report, now.report];
  const whole = Math.max(frameCycles(a), frameCycles(b));
  const names = Object.keys({ ...a.units, ...b.units });
  const rows = names.map(name => {
    const [before, after] = [a.units?.[name], b.units?.[name]];
    const cells = STATES.map(([, , of]) => el("td", { class: "right" }, before && after ? change(of(after), of(before)) : "\u2013"));
    return el("tr", {}, el("th", {}, name), el("td", { class: "two-bars" }, bar(before, whole), bar(after, whole)), ...cells);
  });
  const head = ["unit", "pinned above, now below", ...STATES.map(([, name]) => name)].map(name => el("th", { scope: "col" }, name));
  const set = settings(a.config, b.config).map(([key, from, to]) => el("li", {}, el("code", {}, key), ` ${from} \u2192 ${to}`));
  const totals = [
    `render cycles: ${thousands(frameCycles(a))} \u2192 ${thousands(frameCycles(b))}, ${change(frameCycles(b), frameCycles(a))}`,
    `memory traffic: ${thousands(memoryBytes(a))} \u2192 ${thousands(memoryBytes(b))} bytes, ${change(memoryBytes(b), memoryBytes(a))}`,
  ];
  if (a.quality && b.quality) {
    const [from, to] = [a.quality.psnr_db, b.quality.psnr_db];
    totals.push(`quality: ${from.toFixed(2)} \u2192 ${to.toFixed(2)} dB, ${change(to, from)}`);
  }
  return el(
    "div", {}, el("ul", {}, ...totals.map(text => el("li", {}, text))),
    el("h3", {}, "Changed parameters"), set.length > 0 ? el("ul", {}, ...set) : el("p", { class: "quiet" }, "None."),
    el("h3", {}, "Cycles per unit"),
    el("div", { class: "wide" }, el("table", { class: "changes" }, el("thead", {}, el("tr", {}, ...head)), el("tbody", {}, ...rows))),
  );
}
