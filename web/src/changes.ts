// Differences between a run and the pinned run.
import { change, decimal, drawing, el, thousands } from "./dom";
import type { Explained, Report, Run, Unit } from "./protocol";

const sum = (of: Record<string, number>): number => Object.values(of).reduce((all, n) => all + n, 0);

export const frameCycles = ({ cycles }: Report): number => cycles?.frames.reduce((all, n) => all + n, 0) ?? 0;

export const memoryBytes = ({ bytes }: Report): number => bytes?.moved ?? 0;

const STATES: [string, string, (unit: Unit) => number][] = [
  ["busy", "busy", unit => unit.busy], ["memory", "memory", unit => sum(unit.memory)],
  ["starved", "starved", unit => sum(unit.starved)], ["blocked", "blocked", unit => sum(unit.blocked)],
];

/** Draws parts side by side. Numbers beside the bar say the same, so it is hidden from screen readers. */
function bar(parts: [className: string, size: number][], whole: number): SVGElement {
  let x = 0;
  return drawing("bar", parts.map(([name, size]) => {
    const width = (1000 * size) / Math.max(1, whole);
    x += width;
    return { class: name, x: x - width, y: 0, width, height: 10 };
  }));
}

const unitBar = (unit: Unit | undefined, whole: number): SVGElement =>
  bar(unit ? STATES.map(([state, , of]) => [state, of(unit)]) : [], whole);

/** Shows the measured causes of the difference. */
export function bars({ text, causes }: Explained): HTMLElement {
  const most = Math.max(...causes.map(({ by }) => Math.abs(by ?? 0)));
  const rows = causes.map(({ cause, by }) => el(
    "tr", {}, el("th", { scope: "row" }, cause), el("td", { class: "two-bars" }, bar([["amount", Math.abs(by ?? 0)]], most)),
    el("td", { class: "right" }, by === null ? "not measured" : change(by, 0).replace("the same", "0")),
  ));
  const table = el("table", { class: "changes" }, el("caption", {}, "Cycles by cause"), el("tbody", {}, ...rows));
  return el("div", { id: "explained" }, el("p", { class: "lead" }, text), ...(rows.length > 0 ? [table] : []));
}

/** Lists the parameters with different values, from one run to the other. */
function settings(a: unknown, b: unknown, path = ""): [string, string, string][] {
  if (JSON.stringify(a) === JSON.stringify(b)) return [];
  const isGroup = (x: unknown): x is Record<string, unknown> => typeof x === "object" && x !== null && !Array.isArray(x);
  if (isGroup(a) && isGroup(b)) return Object.keys({ ...a, ...b }).flatMap(key => settings(a[key], b[key], path ? `${path}.${key}` : key));
  return [[path, JSON.stringify(a) ?? "", JSON.stringify(b) ?? ""]];
}

export function changes(pinned: Run | undefined, now: Run): HTMLElement {
  if (!pinned) return el("p", { class: "quiet" }, "Pin a run, change a parameter and press Compare. The changes and their causes appear here.");
  const [a, b] = [pinned.report, now.report];
  const whole = Math.max(frameCycles(a), frameCycles(b));
  const names = Object.keys({ ...a.units, ...b.units });
  const rows = names.map(name => {
    const [before, after] = [a.units?.[name], b.units?.[name]];
    const cells = STATES.map(([, , of]) => el("td", { class: "right" }, before && after ? change(of(after), of(before)) : "\u2013"));
    return el("tr", {}, el("th", { scope: "row" }, name), el("td", { class: "two-bars" }, unitBar(before, whole), unitBar(after, whole)), ...cells);
  });
  const head = ["unit", "A above, B below", ...STATES.map(([, name]) => name)].map(name => el("th", { scope: "col" }, name));
  const set = settings(a.config, b.config).map(([key, from, to]) => el("li", {}, el("code", {}, key), ` ${from} \u2192 ${to}`));
  const totals = [
    `render cycles: ${thousands(frameCycles(a))} \u2192 ${thousands(frameCycles(b))}, ${change(frameCycles(b), frameCycles(a))}`,
    `memory traffic: ${thousands(memoryBytes(a))} \u2192 ${thousands(memoryBytes(b))} bytes, ${change(memoryBytes(b), memoryBytes(a))}`,
  ];
  const [before, after] = [a.derived["frame_ms"]?.value, b.derived["frame_ms"]?.value];
  if (before !== undefined && after !== undefined) {
    totals.splice(1, 0, `time per frame: ${decimal(before, 3)} \u2192 ${decimal(after, 3)} ms, ${change(after, before)}`);
  }
  if (a.quality && b.quality) {
    const [from, to] = [a.quality.min.psnr_db, b.quality.min.psnr_db];
    totals.push(`quality of the worst frame: ${from.toFixed(2)} \u2192 ${to.toFixed(2)} dB, ${change(to, from)}`);
  }
  return el(
    "div", {}, el("p", {}, el("b", {}, "A"), ` ${pinned.command}`, el("br"), el("b", {}, "B"), ` ${now.command}`), el("ul", {}, ...totals.map(text => el("li", {}, text))),
    el("h3", {}, "Changed parameters"), set.length > 0 ? el("ul", {}, ...set) : el("p", { class: "quiet" }, "None."),
    el("h3", {}, "Cycles per unit"),
    el("div", { class: "wide", tabindex: 0 }, el("table", { class: "changes" }, el("thead", {}, el("tr", {}, ...head)), el("tbody", {}, ...rows))),
  );
}
