// Results of the current run and of pinned runs.
import type { Answered } from "./client";
import { bars, changes } from "./changes";
import { byId, commandParts, el } from "./dom";
import { lead, numbers, panel, tabs, type Shown } from "./panels";
import { chooser, pictures, type Picture, type Stage } from "./picture";
import { problem } from "./problems";
import type { Explained, Run, Step } from "./protocol";
import { reportPage } from "./saved";
import type { Source } from "./session";
import { copied, read, write, type State } from "./state";

/** A run with its pictures, its state and its input. */
export interface Kept extends Shown { pictures: Picture[]; state: State; source: Source }

interface Pinned extends Kept { link: string }

/** Access to the page. */
export interface Access {
  /** Writes the address after a change of the pinned runs or of the tab. */
  written(): void;
  panel(chosen: string): void;
  run(state: State, source: Source, more: Record<string, unknown>): Promise<Answered<Run>>;
  source(state: State): Promise<Source | undefined>;
  /** Explains the difference between two runs. */
  explain(a: Kept, b: Kept): Promise<Explained>;
  /** Returns the steps and waits of a run in these cycles. */
  steps(kept: Kept, from: number, to: number): Promise<Step[]>;
}

/** Maximum number of pinned runs: A and B of a comparison. */
const MOST_PINS = 2;

export class Results {
  /** Addresses of pinned runs that are not computed yet. */
  #wanted: string[] = [];
  #now: Kept | undefined;
  #pins: Pinned[] = [];
  /** Number of pinned runs that came from the address. They precede those of the user. */
  #known = 0;
  #explained: { a: Kept; b: Kept; of: Explained } | undefined;

  constructor(private readonly stage: Stage, private readonly access: Access) {
    const on = (id: string, act: () => void) => byId(id).addEventListener("click", act);
    on("pin", () => this.#pin());
    on("compare", () => void this.#compare());
    on("copy", () => void copy(byId("command").textContent ?? "", byId("copy")));
    on("export", () => this.#export());
    for (const id of ["left", "right"]) byId(id).addEventListener("change", () => this.#choices());
  }

  show(kept: Kept): void {
    this.#now = kept;
    byId("command").replaceChildren(...commandParts(kept.run.command));
    this.#choices();
    this.#render();
  }

  addPictures(more: Picture[]): void {
    this.#now!.pictures.push(...more);
    this.#choices();
  }

  /** Returns the addresses of all pinned runs. */
  links(): string[] {
    return [...this.#pins.map(({ link }) => link), ...this.#wanted];
  }

  // Pinned runs.

  /** Replaces the pinned runs by those with these addresses. `restore` computes the missing ones. */
  want(links: string[]): void {
    const wanted = links.map(link => write(read(link, false)).slice(1)).slice(0, MOST_PINS);
    this.#pins = this.#pins.filter(({ link }) => wanted.includes(link));
    this.#known = this.#pins.length;
    this.#wanted = wanted.filter(link => this.#pins.every(pinned => pinned.link !== link));
    this.#pinsChanged();
  }

  #pin(): void {
    const now = this.#now;
    if (!now?.whole) return;
    // The first one is A. Each further one replaces B.
    this.#pins = [...this.#pins.slice(0, MOST_PINS - 1), { ...now, link: linkOf(now) }];
    this.#known = Math.min(this.#known, MOST_PINS - 1);
    this.#pinsChanged();
    this.access.written();
  }

  #unpin(pinned: Pinned): void {
    this.#known -= Number(this.#pins.indexOf(pinned) < this.#known);
    this.#pins = this.#pins.filter(other => other !== pinned);
    this.#pinsChanged();
    this.access.written();
  }

  #pinsChanged(): void {
    byId("compare").hidden = this.#pins.length === 0;
    byId("compare").textContent = this.#pins.length === MOST_PINS ? "Compare A and B" : "Compare with A";
    byId("pins").replaceChildren(...this.#pins.map((pinned, n) => el(
      "li", { class: "repeat" }, el("b", {}, "AB"[n]!), el("code", {}, ...commandParts(pinned.run.command)),
      el("button", { type: "button", onclick: event => void copy(pinned.run.command, event.target as HTMLElement) }, "Copy"),
      el("button", { type: "button", onclick: () => this.#unpin(pinned) }, "Unpin"),
    )));
    document.documentElement.dataset["pins"] = String(this.#pins.length);
    this.#choices();
    this.#render();
  }

  /** Computes the pinned runs of an address. */
  async restore(): Promise<void> {
    while (this.#wanted.length > 0) {
      const link = this.#wanted[0]!;
      try {
        const state = read(link, false);
        const source = await this.access.source(state);
        if (!source) throw new Error(`The pinned run shows ${state.file}, which this browser does not have.`);
        const { json, rest } = await this.access.run(state, source, { exact: true, limits: true });
        this.#wanted.shift();
        this.#pins.splice(this.#known++, 0, { run: json, rest, whole: true, pictures: pictures(json.pictures, rest), state, source, link });
        this.#pins.length = Math.min(this.#pins.length, MOST_PINS);
        this.#pinsChanged();
      } catch (error) {
        this.#wanted = [];
        problem("input", (error as Error).message);
      }
    }
  }

  /** Compares B with A, or this run with A, and measures the causes. */
  async #compare(): Promise<void> {
    const [a, b] = [this.#pins[0], this.#pins[1] ?? this.#now];
    if (!a || !b) return;
    this.#choose("changes");
    if (this.#explained?.a === a && this.#explained.b === b) return;
    try {
      this.#explained = { a, b, of: await this.access.explain(a, b) };
    } catch (error) {
      problem("run", (error as Error).message);
    }
    this.#render();
  }

  // Display.

  #choices(): void {
    const named = this.#pins.map(({ pictures: [image] }, n) => ({ ...image!, name: n === 0 ? "pinned" : "pinned B", about: "the pinned run's image" }));
    const all = [...this.#now?.pictures ?? [], ...named];
    const [left, right] = [byId<HTMLSelectElement>("left"), byId<HTMLSelectElement>("right")];
    chooser(left, all, undefined);
    chooser(right, all, "nothing");
    const find = (name: string) => all.find(picture => picture.name === name);
    this.stage.show(find(left.value), find(right.value));
  }

  #choose(chosen: string): void {
    this.#now!.state.panel = chosen;
    this.access.panel(chosen);
    this.access.written();
    this.#render();
  }

  #render(): void {
    const now = this.#now;
    if (!now) return;
    this.#buttons(now);
    numbers(byId("numbers"), now, this.#pins[0]);
    lead(byId("limits"), now);
    const name = tabs(byId("tabs"), now.state.panel, chosen => this.#choose(chosen));
    const [a, b] = [this.#pins[0], this.#pins[1] ?? now];
    const known = this.#explained?.a === a && this.#explained?.b === b ? this.#explained?.of : undefined;
    panel(byId("panel"), name, now, {
      changes: () => [...(known ? [bars(known)] : []), changes(a?.run, b.run)],
      steps: (from, to) => this.access.steps(now, from, to),
    });
    const save = byId<HTMLAnchorElement>("save");
    URL.revokeObjectURL(save.href);
    save.href = URL.createObjectURL(new Blob([now.run.text], { type: "application/json" }));
  }

  /** Enables the buttons that need a result. A run is pinned whole: a quick answer has another size and no bottlenecks. */
  #buttons({ whole }: Kept): void {
    for (const id of ["copy", "export"]) byId<HTMLButtonElement>(id).disabled = false;
    const pin = byId<HTMLButtonElement>("pin");
    pin.disabled = !whole;
    pin.title = whole ? "Keep this run and compare others with it" : "You can pin a run once it is complete";
  }

  #export(): void {
    if (!this.#now) return;
    const href = URL.createObjectURL(new Blob([reportPage(this.#now.run, this.#now.pictures)], { type: "text/html" }));
    el("a", { href, download: "report.html" }).click();
    setTimeout(() => URL.revokeObjectURL(href), 60_000);
  }
}

function linkOf({ run, state }: Kept): string {
  return write({ ...copied(state), machine: run.report.machine, panel: "units" }).slice(1);
}

/** Copies a text. Over plain http a browser forbids it, so the text is selected instead. */
async function copy(text: string, button: HTMLElement): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = "Copied";
    setTimeout(() => (button.textContent = "Copy"), 1500);
  } catch {
    getSelection()?.selectAllChildren(button.previousElementSibling!);
  }
}
