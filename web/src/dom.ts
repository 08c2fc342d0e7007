// Helpers for DOM elements and number formats.

type Attributes = Record<string, string | number | boolean | ((event: Event) => void)>;

/** Creates an element with attributes, event handlers (for example "onclick") and children. */
export function el<K extends keyof HTMLElementTagNameMap>(
  name: K, attributes: Attributes = {}, ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(key.slice(2), value);
    else if (value === true) element.setAttribute(key, "");
    else if (value !== false) element.setAttribute(key, String(value));
  }
  element.append(...children);
  return element;
}

/** Creates the parts of a command. A line breaks between two options, not within an option and its value. */
export const commandParts = (command: string): (Node | string)[] =>
  command.split(/ (?=--)/).flatMap((part, n) => [...(n > 0 ? [" "] : []), el("span", {}, part)]);

/** Creates a drawing of rectangles, 1000 wide and 10 high, that fills its place. */
export function drawing(className: string, rectangles: Record<string, string | number>[]): SVGElement {
  const create = (name: string, attributes: Record<string, string | number | boolean>) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
    return element as SVGElement;
  };
  const svg = create("svg", { viewBox: "0 0 1000 10", preserveAspectRatio: "none", class: className, "aria-hidden": true });
  svg.append(...rectangles.map(rectangle => create("rect", rectangle)));
  return svg;
}

export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  return document.getElementById(id) as T;
}

const grouped = new Intl.NumberFormat("en-US");

/** Formats a count with thousands separators. */
export const thousands = (n: number): string => grouped.format(n);

/**
 * Formats a number with this many decimals, as the reports do: with three significant digits below 0.1, and from 1,000 on as a whole
 * number with thousands separators.
 */
export function decimal(x: number, decimals: number): string {
  const size = Math.abs(x);
  if (size === 0 || !Number.isFinite(size)) return x.toFixed(decimals);
  if (size < 1e-6) return x.toExponential(2);
  if (size < 0.1) return x.toFixed(2 - Number(size.toExponential(2).split("e")[1]));
  const fixed = x.toFixed(decimals);
  return Math.abs(Number(fixed)) < 1000 ? fixed : thousands(Math.round(x));
}

export const percent = (part: number, whole: number): string => (whole > 0 ? `${((100 * part) / whole).toFixed(1)} %` : "0 %");

/** Formats a relative change with its sign. */
export function change(now: number, before: number): string {
  if (now === before) return "the same";
  const sign = now > before ? "+" : "\u2212";
  const share = before === 0 ? "" : ` (${sign}${((100 * Math.abs(now - before)) / Math.abs(before)).toFixed(2)} %)`;
  const by = Math.abs(now - before);
  return `${sign}${Number.isInteger(by) ? thousands(by) : decimal(by, 2)}${share}`;
}
