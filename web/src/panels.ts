// Results of a run: headline figures, then one panel at a time.
import { changes, frameCycles, memoryBytes } from "./changes";
import { change, el, thousands } from "./dom";
import type { Report, Run } from "./protocol";
import { timeline } from "./strips";

export interface Shown { run: Run; rest: Uint8Array; /** With exact picture and bottlenecks. */ whole: boolean }

/** Tabs built by the page itself, in addition to the simulator's sections. */
const OWN: [string, string][] = [["timeline", "Timeline"], ["changes", "Changes"]];
/** Sections whose content the page already shows elsewhere. */
const ELSEWHERE = ["pictures", "warnings"];
const FIRST = ["units", "diagram", "bottlenecks", "timeline", "changes"];

function figures(report: Report): [string, number, (n: number) => string][] {
  const frames = Math.max(1, report.cycles?.frames.length ?? 1);
  const each = frames > 1 ? " per frame" : "";
  const list: [string, number, (n: number) => string][] = [];
  if (report.cycles) list.push([`cycles${each}`, frameCycles(report) / frames, n => thousands(Math.floor(n))]);
  if (report.quality) list.push(["dB against the exact picture", report.quality.psnr_db, n => n.toFixed(2)]);
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
  into.textContent = !cycles ? "" : whole ? sentence : "The bottleneck is measured when the picture rests.";
  into.classList.toggle("quiet", !whole);
}

function list(run: Run): [string, string][] {
  const sections = run.sections.filter(({ id }) => !ELSEWHERE.includes(id)).map(({ id, title }): [string, string] => [id, title]);
  const all = [...sections, ...OWN];
  const first = FIRST.flatMap(id => all.filter(([of]) => of === id));
  return [...first, ...all.filter(([id]) => !FIRST.includes(id))];
}

const SHORT: Record<string, string> = { units: "Units", bottlenecks: "Bottlenecks", diagram: "Block diagram" };

export function tabs(into: HTMLElement, run: Run, chosen: string, choose: (panel: string) => void): string {
  const all = list(run);
  const now = all.some(([id]) => id === chosen) ? chosen : "units";
  const buttons = all.map(([id, title]) => {
    const selected = id === now;
    return el("button", {
      type: "button", role: "tab", id: `tab-${id}`, "aria-controls": "panel", "aria-selected": String(selected),
      tabindex: selected ? 0 : -1, onclick: () => choose(id),
      onkeydown: event => {
        const by = { ArrowRight: 1, ArrowLeft: -1 }[(event as KeyboardEvent).key];
        if (by === undefined) return;
        const next = all[(all.findIndex(([of]) => of === id) + by + all.length) % all.length]![0];
        choose(next);
        document.getElementById(`tab-${next}`)?.focus();
      },
    }, SHORT[id] ?? title);
  });
  // Keeps the keyboard focus on its tab.
  const held = into.contains(document.activeElement) ? document.activeElement!.id : undefined;
  into.replaceChildren(...buttons);
  if (held) document.getElementById(held)?.focus();
  return now;
}

export function panel(into: HTMLElement, name: string, now: Shown, pinned: Shown | undefined): void {
  into.setAttribute("aria-labelledby", `tab-${name}`);
  if (name === "timeline") return into.replaceChildren(timeline(now.run, now.rest));
  if (name === "changes") return into.replaceChildren(changes(pinned?.run, now.run));
  const open = new Set([...into.querySelectorAll("details[open] > summary")].map(summary => summary.textContent));
  // The simulator generates this markup and escapes it. Scripts in it would not run.
  into.innerHTML = now.run.sections.find(({ id }) => id === name)?.html ?? "";
  for (const details of into.querySelectorAll("details")) {
    if (open.has(details.querySelector("summary")?.textContent ?? "")) details.open = true;
  }
}
