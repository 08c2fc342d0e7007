// The report of a run as one page, which needs no script and loads nothing: the sections of `basrelief --html`.
import { decimal, el, thousands } from "./dom";
import { averagedFrames, figures } from "./panels";
import type { Picture } from "./picture";
import type { Report, Run } from "./protocol";

const POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'";
/** Pictures of the machine's own. Others are auxiliary outputs. */
const SHOWN = ["image", "reference", "difference"];

/** Returns the style sheet of reports. The last rule of the page holds its own style (build.mjs). */
const style = (): string => [...document.styleSheets[0]!.cssRules].slice(0, -1).map(({ cssText }) => cssText).join("\n");

function figure({ about, width, height, rgba }: Picture): HTMLElement {
  const canvas = el("canvas", { width, height });
  canvas.getContext("2d")!.putImageData(new ImageData(rgba, width, height), 0, 0);
  return el("figure", {}, el("img", { src: canvas.toDataURL(), alt: about, width, height }), el("figcaption", {}, about));
}

/** Returns the figures of the head: name and number. */
function headline(report: Report): [string, string][] {
  const list = figures(report).map(([name, n, told]): [string, string] => [name, told(n)]);
  const { derived, outcome, config } = report;
  const [key, per] = Object.entries(derived).find(([key]) => key.startsWith("cycles_per_")) ?? [];
  if (key && per) list.splice(1, 0, [key.replaceAll("_", " "), decimal(per.value, 2)]);
  const ms = derived[outcome.kind === "complete" ? "frame_ms" : "time_ms"];
  const each = averagedFrames(report) > 1 ? " per frame" : "";
  if (ms) list.push([`ms${each} at ${thousands((config["clock"] as { hz: number }).hz / 1e6)} MHz`, decimal(ms.value, 3)]);
  return list;
}

export function reportPage({ report, text, sections }: Run, pictures: Picture[]): string {
  const { machine, input, size, outcome } = report;
  const what = `${machine} \u00b7 ${input.name} \u00b7 ${size.width}\u00a0\u00d7\u00a0${size.height}`;
  const part = (id: string, title: string, ...content: Node[]) =>
    el("section", { id, "aria-labelledby": `${id}-title` }, el("h2", { id: `${id}-title` }, title), ...content);
  const shown = sections.map(({ id, title, html }) => {
    const content = document.createElement("template");
    content.innerHTML = html;
    return part(id, title, content.content);
  });
  const kept = pictures.filter(({ name }) => SHOWN.includes(name));
  const small = size.width < 480 ? "pictures small" : "pictures";
  shown.splice(1, 0, part("pictures", "Images", el("div", { class: small }, ...kept.map(figure))));
  const links = shown.map(({ id, firstElementChild }) => el("a", { href: `#${id}` }, firstElementChild!.textContent!));
  const numbers = headline(report).map(([name, number]) => el("div", {}, el("dt", {}, name), el("dd", {}, number)));
  const ended = outcome.kind === "complete" ? [] : [el("p", { class: "bad", role: "alert" }, outcome.message ?? "The run did not finish.")];
  const json = `data:application/json,${encodeURIComponent(text)}`;
  const body = el(
    "body", {}, el("header", {}, el("h1", {}, "Basrelief ", el("span", { class: "quiet" }, what)), ...ended, el("dl", { class: "numbers" }, ...numbers)),
    el("nav", { "aria-label": "Parts of this page" }, ...links), el("main", {}, ...shown),
    el("footer", {}, el("p", {}, el("a", { href: json, download: "report.json" }, "Save the report as JSON"))),
  );
  const head = el("title", {}, `${machine} \u00b7 ${input.name} \u00b7 Basrelief`).outerHTML;
  return `<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="${POLICY}">
<meta name="viewport" content="width=device-width, initial-scale=1"><meta name="color-scheme" content="light dark">${head}
<style>${style()}</style></head>${body.outerHTML}</html>\n`;
}
