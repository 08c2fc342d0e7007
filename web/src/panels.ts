// Results of a run: headline figures, then one panel at a time.
import { frameCycles, memoryBytes } from "./changes";
import { change, el, thousands } from "./dom";
import type { Report, Run } from "./protocol";
import { timeline, type Steps } from "./strips";

export interface Shown { run: Run; rest: Uint8Array; /** With reference image and bottlenecks. */ whole: boolean }

/** Groups of results: name in addresses, title, and sections. The timeline and the changes are built by the page itself. */
const GROUPS: [string, string, string[]][] = [
  ["units", "Cycles", ["units", "bottlenecks", "frames", "costs"]], ["timeline", "Timeline", []],
  ["diagram", "Diagram", ["diagram", "fifos", "memories"]],
  ["figures", "Figures", ["quality", "figures", "hardware", "sensitivity", "parameters"]], ["changes", "Changes", []],
];

/** Returns the frames over which totals are averaged: 1 for an incomplete run, whose totals include an unfinished frame. */
export const averagedFrames = ({ outcome, cycles }: Report): number => outcome.kind === "complete" ? Math.max(1, cycles?.frames.length ?? 1) : 1;

/** Names what the quality in a report compares, as the HTML report does. */
const comparedWith = ({ frames }: NonNullable<Report["quality"]>): string =>
  frames && frames.length > 0 ? "reference images, worst frame" : "the reference image";

/** Returns the headline figures: name, value and format. */
export function figures(report: Report): [string, number, (n: number) => string][] {
  const frames = averagedFrames(report);
  const each = frames > 1 ? " per frame" : "";
  const list: [string, number, (n: number) => string][] = [];
  // The last frame of an incomplete run is unfinished.
  const term = report.outcome.kind === "complete" ? "render cycles" : "cycles";
  if (report.cycles) list.push([`${term}${each}`, frameCycles(report) / frames, n => thousands(Math.floor(n))]);
  if (report.quality) list.push([`dB against ${comparedWith(report.quality)}`, report.quality.min.psnr_db, n => n.toFixed(2)]);
  list.push([`bytes of memory traffic${each}`, Math.floor(memoryBytes(report) / frames), thousands]);
  list.push(["gate equivalents", report.hardware.reduce((sum, { area_ge }) => sum + area_ge, 0), thousands]);
  return list;
}

export function numbers(into: HTMLElement, now: Shown, pinned: Shown | undefined): void {
  const before = new Map(pinned ? figures(pinned.run.report).map(([name, n]) => [name, n]) : []);
  into.replaceChildren(...figures(now.run.report).map(([name, n, text]) => {
    const was = before.get(name);
    const told = was === undefined ? [] : [el("span", { class: "delta" }, change(Number(n.toFixed(2)), Number(was.toFixed(2))))];
    return el("div", {}, el("dt", {}, name), el("dd", {}, text(n), ...told));
  }));
}

/** Describes the bottleneck in words, once the simulator has measured it. */
export function lead(into: HTMLElement, { run, whole }: Shown): void {
  const { outcome, cycles } = run.report;
  if (outcome.kind !== "complete") {
    into.textContent = outcome.message ?? `The run ended early: ${outcome.kind}.`;
    return;
  }
  const html = run.sections.find(({ id }) => id === "bottlenecks")?.html ?? "";
  const sentence = new DOMParser().parseFromString(html, "text/html").querySelector(".lead")?.textContent ?? "";
  into.textContent = !cycles ? "" : whole ? sentence : "The bottleneck is measured when the image rests.";
  into.classList.toggle("quiet", !whole);
}

/** Shows the tabs, and returns the chosen one. An address may name a group or a section in it. */
export function tabs(into: HTMLElement, chosen: string, choose: (panel: string) => void): string {
  const now = (GROUPS.find(([id, , parts]) => id === chosen || parts.includes(chosen)) ?? GROUPS[0]!)[0];
  const buttons = GROUPS.map(([id, title], n) => {
    const selected = id === now;
    return el("button", {
      type: "button", role: "tab", id: `tab-${id}`, "aria-controls": "panel", "aria-selected": String(selected),
      tabindex: selected ? 0 : -1, onclick: () => choose(id),
      onkeydown: event => {
        const by = { ArrowRight: 1, ArrowLeft: GROUPS.length - 1 }[(event as KeyboardEvent).key];
        if (by === undefined) return;
        const next = GROUPS[(n + by) % GROUPS.length]![0];
        choose(next);
        document.getElementById(`tab-${next}`)?.focus();
      },
    }, title);
  });
  // Keeps the keyboard focus on its tab.
  const held = into.contains(document.activeElement) ? document.activeElement!.id : undefined;
  into.replaceChildren(...buttons);
  if (held) document.getElementById(held)?.focus();
  return now;
}

/** Shows the group with this name. Two groups are made by functions. */
export function panel(into: HTMLElement, name: string, { run, rest }: Shown, made: { changes(): HTMLElement[]; steps: Steps }): void {
  into.setAttribute("aria-labelledby", `tab-${name}`);
  if (name === "timeline") return timeline(into, run, rest, made.steps);
  if (name === "changes") return into.replaceChildren(...made.changes());
  const open = new Set([...into.querySelectorAll("details[open] > summary")].map(summary => summary.textContent));
  const parts = GROUPS.find(([id]) => id === name)![2].flatMap(id => run.sections.filter(section => section.id === id));
  // The simulator generates this markup and escapes it. Scripts in it would not run.
  into.innerHTML = parts.map(({ id, title, html }) => `<section id="${id}" aria-labelledby="${id}-title"><h2 id="${id}-title">${title}</h2>${html}</section>`).join("");
  for (const details of into.querySelectorAll("details")) {
    if (open.has(details.querySelector("summary")?.textContent ?? "")) details.open = true;
  }
}
