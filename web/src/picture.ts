// The picture area: two pictures with a movable divider, rotation by dragging, and details of the pixel under the pointer.
import { bytesAt } from "./client";
import { decimal, el } from "./dom";
import type { PictureInfo, Pixel } from "./protocol";

export interface Picture { name: string; about: string; width: number; height: number; rgba: Uint8ClampedArray<ArrayBuffer> }

export function pictures(list: PictureInfo[], rest: Uint8Array): Picture[] {
  return list.map(({ name, about, at, width, height }) => {
    return { name, about, width, height, rgba: new Uint8ClampedArray(bytesAt(rest, at)) };
  });
}

export interface Turning {
  /** Turns the view by these degrees. `rests` is true when the user ends the drag. */
  turn(around: number, up: number, rests: boolean): void;
  zoom(factor: number): void;
  reset(): void;
}

/** Degrees of a drag across the whole picture. */
const ACROSS = 180;
const STEP = 10;

export class Stage {
  #left: Picture | undefined;
  #right: Picture | undefined;
  #split = 1;
  /** The pixel under the pointer. */
  #pointed = "";

  constructor(
    private readonly canvas: HTMLCanvasElement, private readonly divider: HTMLInputElement, private readonly says: HTMLElement,
    private readonly turning: Turning, private readonly costs: (x: number, y: number) => Promise<Pixel | null>,
  ) {
    divider.addEventListener("input", () => {
      this.#split = Number(divider.value) / 1000;
      this.#draw();
    });
    canvas.addEventListener("pointerdown", event => this.#drag(event));
    canvas.addEventListener("pointermove", event => this.#point(event));
    canvas.addEventListener("pointerleave", () => {
      this.#pointed = "";
      this.#caption();
    });
    canvas.addEventListener("dblclick", () => turning.reset());
    canvas.addEventListener("wheel", event => {
      if (!event.ctrlKey && document.activeElement !== canvas) return;
      event.preventDefault();
      turning.zoom(event.deltaY < 0 ? 1.1 : 1 / 1.1);
    }, { passive: false });
    canvas.addEventListener("keydown", event => this.#key(event));
  }

  /** Describes the left picture anew. */
  rename(about: string): void {
    if (this.#left) this.#left = { ...this.#left, about };
    this.#caption();
  }

  show(left: Picture | undefined, right: Picture | undefined): void {
    this.#left = left;
    this.#right = right;
    this.divider.hidden = right === undefined;
    this.#split = right === undefined ? 1 : Number(this.divider.value) / 1000;
    this.#draw();
    this.#caption();
  }

  #caption(): void {
    const right = this.#right ? ` Right of the line: ${this.#right.about}.` : "";
    this.says.textContent = this.#left ? `${this.#right ? "Left" : "Shown"}: ${this.#left.about}.${right}` : "";
  }

  #draw(): void {
    const left = this.#left;
    if (!left) return;
    const { canvas } = this;
    if (canvas.width !== left.width || canvas.height !== left.height) [canvas.width, canvas.height] = [left.width, left.height];
    canvas.classList.toggle("small", left.width < 640);
    canvas.parentElement!.style.setProperty("--ratio", String(left.width / left.height));
    const context = canvas.getContext("2d")!;
    context.putImageData(new ImageData(left.rgba, left.width, left.height), 0, 0);
    const right = this.#right;
    if (!right) return;
    const x = Math.round(this.#split * left.width);
    if (right.width === left.width && right.height === left.height) {
      context.putImageData(new ImageData(right.rgba, right.width, right.height), 0, 0, x, 0, left.width - x, left.height);
    }
    context.fillStyle = "#fff";
    context.fillRect(x - 1, 0, 2, left.height);
    context.fillStyle = "#000";
    context.fillRect(x, 0, 1, left.height);
  }

  #drag(event: PointerEvent): void {
    if (event.button !== 0) return;
    const { canvas, turning } = this;
    canvas.setPointerCapture(event.pointerId);
    let at = [event.clientX, event.clientY] as const;
    const scale = ACROSS / canvas.clientWidth;
    const moved = (next: PointerEvent, rests: boolean) => {
      turning.turn(-(next.clientX - at[0]) * scale, (next.clientY - at[1]) * scale, rests);
      at = [next.clientX, next.clientY];
    };
    const move = (next: PointerEvent) => moved(next, false);
    const up = (next: PointerEvent) => {
      moved(next, true);
      canvas.removeEventListener("pointermove", move);
      canvas.removeEventListener("pointerup", up);
      canvas.removeEventListener("pointercancel", up);
    };
    canvas.addEventListener("pointermove", move);
    canvas.addEventListener("pointerup", up);
    canvas.addEventListener("pointercancel", up);
  }

  #key(event: KeyboardEvent): void {
    const { turning } = this;
    const keys: Record<string, () => void> = {
      ArrowLeft: () => turning.turn(-STEP, 0, true), ArrowRight: () => turning.turn(STEP, 0, true),
      ArrowUp: () => turning.turn(0, STEP, true), ArrowDown: () => turning.turn(0, -STEP, true),
      "+": () => turning.zoom(1.25), "-": () => turning.zoom(0.8), Home: () => turning.reset(),
    };
    const act = keys[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    act();
  }

  /** Describes the pixel under the pointer. */
  #point(event: PointerEvent): void {
    const left = this.#left;
    if (!left || event.buttons !== 0) return;
    const box = this.canvas.getBoundingClientRect();
    const x = Math.floor(((event.clientX - box.left) / box.width) * left.width);
    const y = Math.floor(((event.clientY - box.top) / box.height) * left.height);
    if (x < 0 || y < 0 || x >= left.width || y >= left.height) return;
    // A heat map has a legend below and is therefore taller than the picture. Its values are shown as costs, not as colours.
    const shown = [left, this.#right].filter(picture => picture !== undefined && picture.name !== "cost" && picture.name !== "wait");
    const told = `Pixel ${x}, ${y}: ${shown.map(picture => `${picture!.name} ${at(picture!, x, y)}`).join("; ")}`;
    this.says.textContent = told;
    this.#pointed = `${x},${y}`;
    void this.costs(x, y).then(pixel => {
      if (pixel && this.#pointed === `${x},${y}`) this.says.textContent = `${told}. ${cost(pixel)}`;
    }, () => undefined);
  }
}

/** Maximum number of listed causes for the cycles of a pixel. */
const WAYS = 4;

function cost({ cycles, ways, overdraw, level, entry, polygon }: Pixel): string {
  const causes = { busy: "busy", memory: "waits for", starved: "is starved by", blocked: "is blocked by" };
  const parts = ways.slice(0, WAYS).map(({ unit, kind, of, cycles }) => `${unit} ${causes[kind]}${of ? ` ${of}` : ""} ${decimal(cycles, 1)}`);
  const more = ways.length > WAYS ? " \u2026" : "";
  const facts = [`${overdraw} ${overdraw === 1 ? "fragment" : "fragments"}`];
  if (level !== null) facts.push(`level ${level}`);
  if (entry !== null) facts.push(`entry ${entry}`);
  if (polygon) facts.push(`polygon ${polygon.polygon}${polygon.object === null ? "" : ` of object ${polygon.object}`}`);
  return `${decimal(cycles, 1)} cycles of units: ${parts.join(", ")}${more}; ${facts.join(", ")}`;
}

function at({ rgba, width }: Picture, x: number, y: number): string {
  const [r, g, b, a] = rgba.subarray(4 * (y * width + x), 4 * (y * width + x) + 4);
  return a === 0 ? "empty" : `${r} ${g} ${b}`;
}

/** Fills a selection box with pictures by name. */
export function chooser(select: HTMLSelectElement, list: Picture[], none: string | undefined): void {
  const chosen = select.value;
  const options = list.map(({ name, about }) => el("option", { value: name, title: about }, name));
  select.replaceChildren(...(none === undefined ? [] : [el("option", { value: "" }, none)]), ...options);
  select.value = [...select.options].some(({ value }) => value === chosen) ? chosen : (select.options[0]?.value ?? "");
}
