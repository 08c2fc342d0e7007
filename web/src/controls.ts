// Controls for every parameter, built from the simulator's catalogue.
import { el } from "./dom";
import type { Machine, Parameter } from "./protocol";

export interface Handlers {
  /** Sets a value. `rests` is true when the user releases the control. */
  set(key: string, value: string, rests: boolean): void;
  /** Resets the parameter to its default. */
  reset(key: string): void;
}

const asOption = (value: unknown): string => (typeof value === "string" ? value : JSON.stringify(value));

/** Returns the positions of a slider between both limits. For whole numbers they are 1, 1.5, 2, 3, 4, 6 ... (powers of two, and
 *  1.5 times each). */
export function stops(min: number, max: number, whole: boolean, around: number): number[] {
  const places = new Set([min, max, around]);
  if (whole && max - min <= 64) {
    for (let n = min; n <= max; n++) places.add(n);
  } else if (whole) {
    if (min <= 0) places.add(0);
    for (let n = 1; n <= max; n *= 2) for (const between of [n, n * 1.5]) if (Number.isInteger(between)) places.add(between);
  } else {
    for (let n = 0; n <= 40; n++) places.add(Number((min + ((max - min) * n) / 40).toPrecision(4)));
  }
  return [...places].filter(n => n >= min && n <= max).sort((a, b) => a - b);
}

function slider(parameter: Parameter, value: string, set: Handlers["set"]): HTMLElement[] {
  const { key, takes } = parameter;
  if (takes.kind !== "integer" && takes.kind !== "number") return [];
  const now = Number(value);
  const places = stops(takes.min, takes.max, takes.kind === "integer", Number(parameter.default));
  const nearest = Math.max(0, places.findLastIndex(place => place <= now));
  const range = el("input", {
    type: "range", min: 0, max: places.length - 1, step: 1, value: nearest, id: `slide-${key}`, "aria-label": `${key}, slider`,
    "aria-valuetext": `${value} ${parameter.unit}`,
  });
  const exact = el("input", { type: "text", inputmode: "decimal", value, id: `set-${key}`, "aria-describedby": `about-${key}` });
  const move = (rests: boolean) => {
    exact.value = String(places[Number(range.value)]);
    range.setAttribute("aria-valuetext", `${exact.value} ${parameter.unit}`);
    set(key, exact.value, rests);
  };
  range.addEventListener("input", () => move(false));
  range.addEventListener("change", () => move(true));
  exact.addEventListener("change", () => set(key, exact.value.trim(), true));
  return [range, exact];
}

function inputs(parameter: Parameter, value: string, set: Handlers["set"]): HTMLElement[] {
  const { key, takes } = parameter;
  const described = { id: `set-${key}`, "aria-describedby": `about-${key}` };
  switch (takes.kind) {
    case "switch": {
      const box = el("input", { type: "checkbox", ...described });
      box.checked = value === "true";
      box.addEventListener("change", () => set(key, String(box.checked), true));
      return [box];
    }
    case "choice": {
      const select = el("select", described, ...takes.choices.map(({ name, about }) => el("option", { value: name, title: about }, name)));
      select.value = value;
      select.addEventListener("change", () => set(key, select.value, true));
      return [select];
    }
    case "text": {
      const text = el("input", { type: "text", value, ...described });
      text.addEventListener("change", () => set(key, text.value.trim(), true));
      return [text];
    }
    default:
      return slider(parameter, value, set);
  }
}

/** Builds the control of one parameter. */
export function control(parameter: Parameter, given: string | undefined, handlers: Handlers): HTMLElement {
  const { key, unit, about, provenance } = parameter;
  const value = given ?? asOption(parameter.default);
  const standard = asOption(parameter.default);
  const choice = parameter.takes.kind === "choice" ? parameter.takes.choices.find(({ name }) => name === value)?.about : undefined;
  const head = el("div", { class: "control-head" }, el("label", { for: `set-${key}` }, key), el("span", { class: "quiet" }, unit));
  const back = el("button", { type: "button", class: "plain", onclick: () => handlers.reset(key) }, `default ${standard}`);
  head.append(back);
  const source = `${about}${choice ? ` Now: ${choice}` : ""} Default ${provenance.kind}: ${provenance.text}.`;
  const timing = parameter.effect === "timing" ? " Changes times only." : "";
  const marked = (value: string) => {
    back.hidden = value === standard;
    box.className = back.hidden ? "control" : "control changed";
  };
  const set = (key: string, value: string, rests: boolean) => {
    marked(value);
    handlers.set(key, value, rests);
  };
  const box = el(
    "div", { "data-key": key }, head,
    el("div", { class: "control-inputs" }, ...inputs(parameter, value, set)),
    el("p", { class: "about", id: `about-${key}` }, source + timing),
  );
  marked(value);
  return box;
}

const group = (key: string): string => key.split(".")[0]!;

/** Builds the controls of a machine: first the changed and the main parameters, then the rest by group. A search shows its
 *  matches only. */
export function controls(machine: Machine, set: Map<string, string>, search: string, handlers: Handlers): HTMLElement[] {
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  const one = (parameter: Parameter) => control(parameter, set.get(parameter.key), handlers);
  if (words.length > 0) {
    const found = machine.parameters.filter(({ key, about }) => words.every(word => `${key} ${about}`.toLowerCase().includes(word)));
    return found.length > 0 ? found.map(one) : [el("p", { class: "quiet" }, "No parameter matches.")];
  }
  const first = machine.parameters.filter(({ key }) => set.has(key) || machine.main.includes(key));
  const rest = Map.groupBy(machine.parameters.filter(parameter => !first.includes(parameter)), ({ key }) => group(key));
  const groups = [...rest].map(([name, parameters]) => {
    const details = el("details", {}, el("summary", {}, `${name} (${parameters.length})`));
    // Built when the group is opened, because there are hundreds of parameters.
    details.addEventListener("toggle", () => details.childElementCount === 1 && details.append(...parameters.map(one)));
    return details;
  });
  const others = el("details", { class: "others" }, el("summary", {}, `Other parameters (${machine.parameters.length - first.length})`), ...groups);
  return [...first.map(one), others];
}
