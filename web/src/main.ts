// The page: its state, the questions after a change, and the display of the answers.
import { bytesAt, Client, type Answered } from "./client";
import { controls } from "./controls";
import { byId, el } from "./dom";
import { chosen, dropped, type Dropped } from "./files";
import { lead, numbers, panel, tabs, type Shown } from "./panels";
import { Path } from "./path";
import { chooser, pictures, Stage, type Picture } from "./picture";
import type { Catalogue, Machine, Meanwhile, Pixel, Report, Run, Taken, Told } from "./protocol";
import { read, SIZES, write, type State } from "./state";

/** Picture size while the view moves. */
const MOVING: [number, number] = [320, 240];
/** Delay before the complete answer \[ms\]: long enough not to start it between two movements. */
const REST = 200;

/** True if the page is a viewer, which draws the scene of its own server. */
const SERVED = document.documentElement.dataset["from"] !== undefined;

export interface Embedded { wasm(): Promise<ArrayBuffer>; worker(): Worker }

export async function page(embedded: Embedded): Promise<void> {
  const answered = byId("answered");
  try {
    answered.textContent = "loading the simulator\u2026";
    const client = new Client(embedded.worker, await embedded.wasm());
    const { json } = await client.ask<Catalogue>({ ask: "catalogue" });
    await new Page(client, json).begin();
  } catch (error) {
    answered.textContent = "";
    problem(String(error instanceof Error ? error.message : error));
  }
}

function problem(text: string | undefined): void {
  const place = byId("problem");
  place.hidden = text === undefined;
  place.textContent = text ?? "";
}

class Page {
  #state: State;
  /** Dropped files, kept for a restarted simulator. */
  #files: Dropped | undefined;
  #taken: Taken | undefined;
  #shown: Shown | undefined;
  #pinned: (Shown & { pictures: Picture[] }) | undefined;
  #pictures: Picture[] = [];
  #stage: Stage;
  #path = new Path();
  /** Counts changes. An answer to an older version is discarded. */
  #version = 0;
  #busy = false;
  /** The version with known pixel costs. */
  #costly = -1;
  /** The version of the current question. */
  #asking = 0;
  #rest: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly client: Client, private readonly catalogue: Catalogue) {
    this.#state = read(location.hash, SERVED);
    if (SERVED) this.catalogue = { ...catalogue, machines: catalogue.machines.filter(({ fetches }) => fetches) };
    this.#stage = new Stage(byId<HTMLCanvasElement>("picture"), byId<HTMLInputElement>("divider"), byId("caption"), {
      turn: (around, up, rests) => this.#turn(around, up, rests),
      zoom: factor => this.#view({ zoom: round(Math.min(100, Math.max(0.01, (this.#state.view.zoom ?? 1) * factor)), 3) }, true),
      reset: () => this.#view({ turn: undefined, zoom: undefined }, true),
    }, (x, y) => this.#pixel(x, y));
  }

  async begin(): Promise<void> {
    this.#wire();
    // An address cannot contain a file.
    if (this.#state.demo === null && !SERVED) this.#state.demo = "golf-ball";
    await this.#take();
  }

  get #machine(): Machine {
    const { machines } = this.catalogue;
    const name = this.#state.machine ?? this.#taken?.machine;
    return machines.find(machine => machine.name === name) ?? machines[0]!;
  }

  // Input.

  async #take(): Promise<void> {
    this.#version++;
    // Blocks questions about the previous input until the new input is loaded.
    this.#taken = undefined;
    clearTimeout(this.#rest);
    try {
      const asked = this.#tellWhat();
      byId("answered").textContent = "opening\u2026";
      this.#taken = (await asked).json;
      this.#path.forget();
      problem(this.#taken.warnings?.join(" ") || undefined);
    } catch (error) {
      return problem((error as Error).message);
    }
    this.#fill();
    this.#changed(true);
  }

  /** Sends the input to the simulator. */
  #tellWhat(): Promise<Answered<Taken>> {
    if (SERVED) return this.client.ask<Taken>({ ask: "from", server: new URL(".", location.href).href });
    const { demo } = this.#state;
    const files = this.#files;
    return files && demo === null
      ? this.client.ask<Taken>({ ask: "files", name: files.name, files: files.files }, files.rest)
      : this.client.ask<Taken>({ ask: "demo", name: demo });
  }

  async #open(files: Promise<Dropped>): Promise<void> {
    try {
      this.#files = await files;
      Object.assign(this.#state, { demo: null, machine: this.#machine.name, set: new Map(), view: { size: this.#state.view.size } });
      await this.#take();
    } catch (error) {
      problem((error as Error).message);
    }
  }

  // Changes.

  #turn(around: number, up: number, rests: boolean): void {
    if (!this.#taken?.scene) return;
    const [a, b] = this.#state.view.turn ?? [0, 0];
    const turned = (((a + around + 540) % 360) + 360) % 360 - 180;
    this.#view({ turn: [round(turned, 1), round(Math.min(90, Math.max(-110, b + up)), 1)] }, rests);
  }

  #view(change: Record<string, unknown>, rests: boolean): void {
    Object.assign(this.#state.view, change);
    for (const key of ["turn", "zoom", "light", "frames", "orbit"] as const) {
      if (this.#state.view[key] === undefined) delete this.#state.view[key];
    }
    this.#changed(rests);
  }

  /** Requests new answers after a change: a quick one at once, and a complete one when the input rests. */
  #changed(rests: boolean): void {
    this.#version++;
    Object.assign(document.documentElement.dataset, { asked: this.#version, settled: false });
    history.replaceState(null, "", write(this.#state));
    clearTimeout(this.#rest);
    void this.#quick();
    this.#rest = setTimeout(() => void this.#whole(), rests ? REST / 4 : REST);
  }

  #question(size: [number, number], more: Record<string, unknown>): Record<string, unknown> {
    const view = { ...this.#state.view, size };
    return { ask: "run", machine: this.#machine.name, set: [...this.#state.set], view, ...more };
  }

  /** Requests a quick answer. During another question it does nothing, because that question's caller asks again afterwards. */
  async #quick(): Promise<void> {
    if (this.#busy || !this.#taken) return;
    const size = this.#state.view.size;
    const small = size[0] * size[1] > MOVING[0] * MOVING[1] ? MOVING : size;
    const version = this.#version;
    await this.#run(this.#question(small, {}), false, version);
    if (version !== this.#version) void this.#quick();
  }

  /** Requests the picture in full size, then the comparison with the exact picture, then the bottlenecks. */
  async #whole(): Promise<void> {
    const version = this.#version;
    if (this.#busy) {
      clearTimeout(this.#rest);
      this.#rest = setTimeout(() => void this.#whole(), 20);
      return;
    }
    const size = this.#state.view.size;
    const last = { exact: true, limits: true };
    // A server's scene has no exact picture, because that needs all texels.
    for (const more of SERVED ? [{}, last] : [{}, { exact: true }, last]) {
      if (version !== this.#version || !this.#taken) return;
      if (!(await this.#run(this.#question(size, more), "limits" in more, version))) break;
    }
    if (version === this.#version && this.#taken) await this.#costs(this.#question(size, {}), version);
    if (version !== this.#version) void this.#quick();
  }

  /** Returns true if the run was answered. */
  async #run(question: Record<string, unknown>, whole: boolean, version: number): Promise<boolean> {
    this.#busy = true;
    this.#asking = version;
    const patience = setTimeout(() => (byId("stop").hidden = false), 1500);
    try {
      const began = performance.now();
      this.#path.begin(version);
      const { json, rest, ...took } = await this.client.ask<Told>(question, undefined, this.#meanwhile());
      const text = new TextDecoder().decode(bytesAt(rest, json.report));
      this.#show({ json: { ...json, text, report: JSON.parse(text) as Report }, rest, ...took }, whole, performance.now() - began);
      problem(this.#taken?.warnings?.join(" ") || undefined);
      return true;
    } catch (error) {
      if (version === this.#version) problem((error as Error).message);
      return false;
    } finally {
      clearTimeout(patience);
      byId("stop").hidden = true;
      this.#busy = false;
    }
  }

  /** Handles the progress of a question: received bytes and intermediate pictures. */
  #meanwhile(): (told: Meanwhile) => void {
    let bytes = 0;
    return told => {
      if ("came" in told) return this.#path.came((bytes += told.came));
      const { at, width, height } = told.sketch;
      const [sketch] = pictures([{ name: "image", about: "a picture that better ones follow", at, width, height }], told.rest);
      this.#stage.show(sketch, undefined);
      const page = document.documentElement.dataset;
      page["sketches"] = String(Number(page["sketches"] ?? 0) + 1);
    };
  }

  /** Requests the cost of each pixel. Adds the cost pictures and enables details under the pointer. */
  async #costs(question: Record<string, unknown>, version: number): Promise<void> {
    this.#busy = true;
    try {
      const { json, rest } = await this.client.ask<Pick<Told, "pictures">>({ ...question, ask: "costs" });
      if (version === this.#version) {
        this.#pictures = [...this.#pictures, ...pictures(json.pictures, rest)];
        this.#pictureChoices();
        this.#costly = version;
        document.documentElement.dataset["costs"] = String(version);
      }
    } catch {
      // A run without pixel costs, for example one that ends early, has no such pictures.
    } finally {
      this.#busy = false;
    }
  }

  async #pixel(x: number, y: number): Promise<Pixel | null> {
    if (this.#busy || this.#costly !== this.#version) return null;
    return (await this.client.ask<Pixel | null>({ ask: "pixel", x, y })).json;
  }

  // Display.

  #show({ json, rest, ms, waited }: Answered<Run>, whole: boolean, answered: number): void {
    const { report } = json;
    this.#shown = { run: json, rest, whole };
    const fresh = pictures(json.pictures, rest);
    this.#pictures = fresh;
    byId("what").textContent = `${report.machine} \u00b7 ${report.input.name} \u00b7 ${report.size.width} \u00d7 ${report.size.height}`;
    const waiting = waited > 0 ? `, ${waited.toFixed(0)} waiting for the server` : "";
    byId("answered").textContent = `answered in ${answered.toFixed(0)} ms, ${(ms - waited).toFixed(0)} of them computing${waiting}`;
    byId("command").textContent = json.command;
    this.#pictureChoices();
    this.#path.show(json.path, report);
    this.#results();
    this.#tell(whole, answered);
  }

  /** Publishes attributes for automated tests: the version of the answer, the time of its first answer, and whether all questions
   *  are answered. */
  #tell(whole: boolean, answered: number): void {
    const told = document.documentElement.dataset;
    const current = this.#asking === this.#version;
    if (told["version"] !== String(this.#asking)) told["first"] = answered.toFixed(1);
    told["version"] = String(this.#asking);
    told["settled"] = String(whole && current);
  }

  #pictureChoices(): void {
    const all = this.#pinned ? [...this.#pictures, ...this.#pinned.pictures] : this.#pictures;
    const [left, right] = [byId<HTMLSelectElement>("left"), byId<HTMLSelectElement>("right")];
    chooser(left, all, undefined);
    chooser(right, all, "nothing");
    const named = (name: string) => all.find(picture => picture.name === name);
    this.#stage.show(named(left.value), named(right.value));
  }

  #results(): void {
    const shown = this.#shown;
    if (!shown) return;
    numbers(byId("numbers"), shown, this.#pinned);
    lead(byId("limits"), shown);
    const name = tabs(byId("tabs"), shown.run, this.#state.panel, chosen => {
      this.#state.panel = chosen;
      history.replaceState(null, "", write(this.#state));
      this.#results();
    });
    panel(byId("panel"), name, shown, this.#pinned);
    const save = byId<HTMLAnchorElement>("save");
    URL.revokeObjectURL(save.href);
    save.href = URL.createObjectURL(new Blob([shown.run.text], { type: "application/json" }));
  }

  #pin(pinned: boolean): void {
    const shown = this.#shown;
    const kept = this.#pictures.filter(({ name }) => name === "image");
    const pictures = kept.map(picture => ({ ...picture, name: "pinned", about: "the pinned run's picture" }));
    this.#pinned = pinned && shown ? { ...shown, pictures } : undefined;
    byId("unpin").hidden = !this.#pinned;
    this.#pictureChoices();
    this.#results();
  }

  /** Fills choices and controls from the state. */
  #fill(): void {
    const { machines, demos } = this.catalogue;
    const machine = byId<HTMLSelectElement>("machine");
    machine.replaceChildren(...machines.map(({ name, about }) => el("option", { value: name, title: about }, name)));
    machine.value = this.#machine.name;
    const own = this.#state.demo === null ? [el("option", { value: "" }, this.#files?.name ?? "a file")] : [];
    const demo = byId<HTMLSelectElement>("demo");
    const known = demos.some(({ name }) => name === this.#state.demo) || this.#state.demo === null;
    const named = known ? [] : [el("option", { value: this.#state.demo! }, this.#state.demo!)];
    demo.replaceChildren(...own, ...named, ...demos.map(({ name, about }) => el("option", { value: name, title: about }, name)));
    demo.value = this.#state.demo ?? "";
    const size = byId<HTMLSelectElement>("size");
    const sizes = SIZES.some(([w, h]) => `${w}x${h}` === this.#state.view.size.join("x")) ? SIZES : [...SIZES, this.#state.view.size];
    size.replaceChildren(...sizes.map(([w, h]) => el("option", { value: `${w}x${h}` }, `${w} \u00d7 ${h}`)));
    size.value = this.#state.view.size.join("x");
    byId<HTMLInputElement>("frames").value = String(this.#state.view.frames ?? "");
    byId<HTMLInputElement>("orbit").value = String(this.#state.view.orbit ?? "");
    this.#parameters();
  }

  #parameters(): void {
    const search = byId<HTMLInputElement>("search").value;
    byId("controls").replaceChildren(...controls(this.#machine, this.#state.set, search, {
      set: (key, value, rests) => {
        this.#state.set.set(key, value);
        this.#changed(rests);
      },
      reset: key => {
        this.#state.set.delete(key);
        this.#parameters();
        this.#changed(true);
      },
    }));
    byId("defaults").hidden = this.#state.set.size === 0;
  }

  #wire(): void {
    const on = (id: string, event: string, act: (element: HTMLInputElement & HTMLSelectElement) => void) =>
      byId(id).addEventListener(event, () => act(byId<HTMLInputElement & HTMLSelectElement>(id)));
    on("machine", "change", ({ value }) => {
      Object.assign(this.#state, { machine: value, set: new Map() });
      this.#parameters();
      this.#changed(true);
    });
    on("demo", "change", ({ value }) => {
      if (value === "") return;
      Object.assign(this.#state, { demo: value, machine: null, set: new Map(), view: { size: this.#state.view.size } });
      void this.#take();
    });
    on("size", "change", ({ value }) => this.#view({ size: value.split("x").map(Number) }, true));
    on("frames", "change", ({ value }) => this.#view({ frames: value === "" ? undefined : Number(value) }, true));
    on("orbit", "change", ({ value }) => this.#view({ orbit: value === "" ? undefined : Number(value) }, true));
    on("light", "input", ({ value }) => this.#view({ light: towards(Number(value)) }, false));
    on("light", "change", ({ value }) => this.#view({ light: towards(Number(value)) }, true));
    on("search", "input", () => this.#parameters());
    on("defaults", "click", () => {
      this.#state.set.clear();
      this.#parameters();
      this.#changed(true);
    });
    on("left", "change", () => this.#pictureChoices());
    on("right", "change", () => this.#pictureChoices());
    on("pin", "click", () => this.#pin(true));
    on("unpin", "click", () => this.#pin(false));
    on("stop", "click", () => this.#stop());
    on("copy", "click", button => {
      void navigator.clipboard.writeText(byId("command").textContent ?? "").then(() => (button.textContent = "Copied"));
      setTimeout(() => (button.textContent = "Copy"), 1500);
    });
    addEventListener("hashchange", () => {
      this.#state = read(location.hash, SERVED);
      void this.#take();
    });
    if (SERVED) return;
    on("open", "click", () => byId("files").click());
    on("files", "change", ({ files }) => files && files.length > 0 && void this.#open(chosen(files)));
    this.#wireDrop();
  }

  #wireDrop(): void {
    const veil = byId("drop");
    window.addEventListener("dragover", (event: DragEvent) => {
      event.preventDefault();
      veil.hidden = false;
    });
    window.addEventListener("dragleave", (event: DragEvent) => event.relatedTarget === null && (veil.hidden = true));
    window.addEventListener("drop", (event: DragEvent) => {
      event.preventDefault();
      veil.hidden = true;
      if (event.dataTransfer) void this.#open(dropped(event.dataTransfer));
    });
  }

  /** Stops a run that takes too long. The input must then be sent again. */
  #stop(): void {
    this.client.restart("Stopped. Change any input to continue.");
    this.#path.forget();
    const version = ++this.#version;
    this.#tellWhat().catch((error: Error) => version === this.#version && problem(error.message));
  }
}

const round = (x: number, digits: number): number => Number(x.toFixed(digits));

/** Returns the direction of a light from above, by its angle around the scene. */
function towards(degrees: number): [number, number, number] {
  const angle = (degrees * Math.PI) / 180;
  return [round(Math.sin(angle), 4), 0.9, round(Math.cos(angle), 4)];
}
