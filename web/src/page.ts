// The page: its state, the questions after a change, and the display of the answers.
import { bytesAt, type Answered, type Client } from "./client";
import type { Handlers } from "./controls";
import { byId } from "./dom";
import { Drafts } from "./drafts";
import { chosen, dropped, type Dropped } from "./files";
import { fill, parameters, resets, round, towards } from "./form";
import { Path } from "./path";
import { pictures, Stage, type Picture } from "./picture";
import { dismissed, problem } from "./problems";
import type { Catalogue, Explained, Machine, Meanwhile, Pixel, Report, Run, Sketch, Step, Taken, Told } from "./protocol";
import { Results, type Kept } from "./results";
import { Session, type Source } from "./session";
import { copied, initial, pinsIn, read, write, type State } from "./state";
import { Steps } from "./steps";
import { keepFiles, keptFiles } from "./stored";

/** Picture size while the view moves. */
const MOVING: [number, number] = [320, 240];
/** Delay before the complete answer \[ms\]: long enough not to start it between two movements. */
const REST = 200;

const STOPPED = "Stopped. Change any input to continue.";

/** True if the page is a viewer, which draws the scene of its own server. */
const SERVED = document.documentElement.dataset["from"] !== undefined;

const why = (error: unknown): string => (error instanceof Error ? error.message : String(error));

export class Page implements Handlers {
  #state: State;
  #source: Source | undefined;
  #taken: Taken | undefined;
  #sources = new Map<string, Source>();
  /** The state of an address whose file is missing. */
  #wanted: State | undefined;
  #catalogue: Catalogue = { version: "", machines: [], demos: [] };
  #session: Session;
  #stage: Stage;
  #steps = new Steps();
  #path = new Path();
  #drafts: Drafts;
  #results: Results;
  /** Counts changes. Only the last one gets a complete answer. */
  #version = 0;
  #busy = false;
  /** True if the image is a draft. */
  #isDraft = false;
  /** True from a stop by the user until the next change. */
  #halted = false;
  /** True during a movement. */
  #moving = false;
  /** Number of inputs that are being opened. Meanwhile no run is requested. */
  #opening = 0;
  /** The version with known pixel costs. */
  #costly = -1;
  #rest: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly client: Client) {
    this.#state = read(location.hash, SERVED);
    this.#session = new Session(client, () => {
      this.#path.forget();
      this.#drafts.forget();
    });
    this.#stage = new Stage(byId<HTMLCanvasElement>("picture"), byId<HTMLInputElement>("divider"), byId("caption"), {
      turn: (around, up, rests) => this.#turn(around, up, rests),
      zoom: factor => this.#view({ zoom: round(Math.min(100, Math.max(0.01, (this.#state.view.zoom ?? 1) * factor)), 3) }, true),
      reset: () => this.#view({ turn: undefined, zoom: undefined }, true),
    }, (x, y) => this.#pixel(x, y));
    this.#drafts = new Drafts({
      ask: (question, body) => this.#session.ask(this.#source!, question, this.#meanwhile(), body),
      came: bytes => this.#path.came(bytes),
      show: ({ draft }, rest) => draft && this.#sketch(draft, rest, "a draft; the textures of grey parts are still loading"),
    });
    this.#results = new Results(this.#stage, {
      written: () => this.#steps.replace(this.#address()),
      panel: panel => (this.#state.panel = panel),
      run: (state, source, more) => this.#runOf(state, source, more),
      source: state => this.#sourceOf(state),
      explain: (a, b) => this.#explain(a, b),
      steps: async ({ state, source }, from, to) => {
        const question = { ...this.#question(state, state.view.size, { cycles: [from, to] }), ask: "steps" };
        return (await this.#session.ask<{ steps: Step[] }>(source, question)).json.steps;
      },
    });
  }

  /** Draws the first picture, then lists the inputs, then computes the rest. */
  async begin(): Promise<void> {
    this.#results.want(pinsIn(location.hash));
    document.documentElement.dataset["asked"] = String(this.#version);
    if (!(await this.#first(this.#state))) await this.#first(initial(SERVED));
    await this.#quick();
    const { json } = await this.client.ask<Catalogue>({ ask: "catalogue" });
    this.#catalogue = SERVED ? { ...json, machines: json.machines.filter(({ fetches }) => fetches) } : json;
    this.#wire();
    this.#fill();
    document.querySelector("main")!.inert = false;
    byId<HTMLDetailsElement>("inputs").open = matchMedia("(min-width: 62rem)").matches;
    void this.#whole();
  }

  /** Opens the input of the address. Returns false if that is impossible, with the reason on the page. */
  async #first(state: State): Promise<boolean> {
    this.#state = state;
    this.#source = await this.#sourceOf(state);
    if (!this.#source) return this.#missing(state);
    try {
      this.#taken = await this.#session.load(this.#source);
      problem("warning", this.#taken.warnings?.join("; "));
      return true;
    } catch (error) {
      problem("input", why(error));
      return SERVED;
    }
  }

  get #machine(): Machine {
    const { machines } = this.#catalogue;
    return machines.find(({ name }) => name === this.#machineName) ?? machines[0]!;
  }

  get #machineName(): string {
    return this.#state.machine ?? this.#taken?.machine ?? "";
  }

  #address(): string {
    return write(this.#wanted ?? this.#state, this.#results.links());
  }

  // Input.

  /** Returns the input of a state, which for a file may be absent. */
  async #sourceOf({ demo, file }: State): Promise<Source | undefined> {
    const key = `${demo} ${file}`;
    const known = this.#sources.get(key);
    if (known) return known;
    const files = file === null || demo !== null ? undefined : await keptFiles(file);
    const source = SERVED ? { server: new URL(".", location.href).href } : demo !== null ? { demo } : files && { files };
    if (source) this.#sources.set(key, source);
    return source;
  }

  /** Asks for the file of an address. */
  #missing(state: State): false {
    this.#wanted = state;
    problem("input", `This address shows ${state.file}, which this browser does not have. Drop ${state.file} on this page to see it.`);
    return false;
  }

  /** Replaces the input and the state. If that fails, both stay. */
  async #open(next: State, source: Source, kind: string | undefined): Promise<boolean> {
    const answered = byId("answered");
    const before = answered.textContent;
    this.#opening++;
    answered.textContent = "opening\u2026";
    try {
      const taken = await this.#session.load(source);
      [this.#state, this.#source, this.#taken, this.#wanted] = [next, source, taken, undefined];
      problem("input", undefined);
      problem("warning", taken.warnings?.join("; "));
    } catch (error) {
      answered.textContent = before;
      problem("input", why(error));
      return false;
    } finally {
      this.#opening--;
    }
    this.#fill();
    this.#changed(true, kind);
    return true;
  }

  async #drop(files: Promise<Dropped>): Promise<void> {
    try {
      const opened = await files;
      const { name } = opened;
      // A file that an address asks for is shown as the address says.
      const next = this.#wanted?.file === name
        ? this.#wanted
        : { ...initial(false), file: name, demo: null, machine: this.#machine.name, panel: this.#state.panel, view: { size: this.#state.view.size } };
      const source = { files: opened };
      if (!(await this.#open(next, source, "input"))) return;
      this.#sources.set(`null ${name}`, source);
      await keepFiles(opened);
    } catch (error) {
      problem("input", why(error));
    }
  }

  /** Shows the state of the address after a move in the history. */
  async #moved(event: PopStateEvent): Promise<void> {
    const isOwn = this.#steps.moved(event);
    const next = read(location.hash, SERVED);
    if (!isOwn) this.#results.want(pinsIn(location.hash));
    // A typed address loads the scene of a server anew.
    if (!isOwn && SERVED) this.#sources.clear();
    const source = await this.#sourceOf(next);
    if (source && source === this.#source) {
      this.#state = next;
      this.#fill();
      return this.#changed(true);
    }
    if (!source) return void this.#missing(next);
    // The address always names the input that is open.
    if (!(await this.#open(next, source, undefined))) this.#steps.replace(this.#address());
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
    resets(this.#state);
    this.#changed(rests, `view ${Object.keys(change).join()}`);
  }

  set(key: string, value: string, rests: boolean): void {
    this.#state.set.set(key, value);
    resets(this.#state);
    this.#changed(rests, `set ${key}`);
  }

  reset(key: string): void {
    this.#state.set.delete(key);
    this.#parameters();
    this.#changed(true, `reset ${key}`);
  }

  /** Notes a change of this kind in the history, or none after a move in the history. Requests new answers. */
  #changed(rests: boolean, kind?: string): void {
    this.#version++;
    this.#halted = false;
    this.#wanted = undefined;
    Object.assign(document.documentElement.dataset, { asked: this.#version, settled: false });
    if (kind === undefined) this.#steps.replace(this.#address());
    else this.#steps.write(this.#address(), kind, rests);
    this.#schedule(rests);
  }

  // Questions.

  /** Requests a quick answer at once, and a complete one when the input rests. */
  #schedule(rests: boolean): void {
    clearTimeout(this.#rest);
    this.#moving = !rests;
    void this.#quick();
    this.#rest = setTimeout(() => void this.#whole(), rests ? REST / 4 : REST);
  }

  #question(state: State, size: [number, number], more: Record<string, unknown>): Record<string, unknown> {
    return { ask: "run", ...this.#runRequest(state, size), ...more };
  }

  #runRequest({ set, view, machine }: State, size: [number, number]): Record<string, unknown> {
    return { machine: machine ?? this.#machineName, set: [...set], view: { ...view, size } };
  }

  /** Requests a quick answer. During another question it does nothing, because that question's caller asks again afterwards. */
  async #quick(): Promise<void> {
    if (this.#busy || this.#halted || this.#opening > 0 || !this.#taken) return;
    const size = this.#state.view.size;
    const small = size[0] * size[1] > MOVING[0] * MOVING[1] ? MOVING : size;
    const version = this.#version;
    const question = this.#question(this.#state, small, {});
    const isMoving = this.#moving;
    await this.#run(question, false, version, SERVED ? () => this.#drafts.now(question, isMoving) : undefined);
    if (version !== this.#version) void this.#quick();
  }

  /** Requests the picture in full size, then the comparison with the reference image, then the bottlenecks. */
  async #whole(): Promise<void> {
    const version = this.#version;
    if (this.#halted) return;
    if (this.#busy || this.#opening > 0) {
      clearTimeout(this.#rest);
      this.#rest = setTimeout(() => void this.#whole(), 20);
      return;
    }
    const size = this.#state.view.size;
    const stale = () => version !== this.#version;
    const last = { exact: true, limits: true };
    let isAnswered = true;
    // A server's scene has no reference image, because that needs all texels.
    for (const more of SERVED ? [{}, last] : [{}, { exact: true }, last]) {
      if (stale() || !this.#taken) return;
      const question = this.#question(this.#state, size, more);
      // A small picture with all its tiles is better than a draft.
      const hides = document.documentElement.dataset["version"] === String(version);
      const ask = SERVED ? () => this.#drafts.whole(question, hides, stale) : undefined;
      if (!(isAnswered = await this.#run(question, "limits" in more, version, ask))) break;
    }
    if (isAnswered && !stale() && this.#taken) await this.#costs(this.#question(this.#state, size, {}), version);
    if (stale()) return void this.#quick();
    if (!this.#halted) await this.#results.restore();
  }

  /** Asks for a run, or lets `ask` do so. Returns true if the run was answered. */
  async #run(
    question: Record<string, unknown>, whole: boolean, version: number,
    ask: () => Promise<Answered<Told> | undefined> = () => this.#session.ask<Told>(this.#source!, question, this.#meanwhile()),
  ): Promise<boolean> {
    const source = this.#source!;
    this.#busy = true;
    const patience = setTimeout(() => {
      byId("stop").hidden = false;
      // A viewer shows how many tiles are here.
      if (!SERVED) byId("answered").textContent = "computing\u2026";
    }, 1500);
    try {
      const began = performance.now();
      this.#path.begin(version);
      const answer = await ask();
      // Another input may have been opened meanwhile.
      if (!answer || source !== this.#source) return false;
      problem("run", undefined);
      this.#show(decoded(answer), whole, performance.now() - began, version);
      return true;
    } catch (error) {
      if (version === this.#version) this.#failed(why(error));
      return false;
    } finally {
      clearTimeout(patience);
      byId("stop").hidden = true;
      this.#busy = false;
    }
  }

  /** Shows an error, and whose image and results are on the page. */
  #failed(why: string): void {
    const { version } = document.documentElement.dataset;
    const isOld = version !== undefined && version !== String(this.#version);
    const shown = this.#isDraft ? "The command and the results" : "The image, the command and the results";
    byId("answered").textContent = isOld ? `${shown} are those of an earlier view.` : "";
    if (this.#isDraft) this.#stage.rename("a draft of a view that is not complete");
    this.#path.end();
    problem("run", why);
  }

  /** Runs another state, for example that of a pinned run. */
  async #runOf(state: State, source: Source, more: Record<string, unknown>): Promise<Answered<Run>> {
    return decoded(await this.#session.ask<Told>(source, this.#question(state, state.view.size, more)));
  }

  /** Records two runs again, and returns the causes of their difference. */
  async #explain(a: Kept, b: Kept): Promise<Explained> {
    for (const [side, { state, source }] of [["a", a], ["b", b]] as const) {
      await this.#session.ask(source, { ask: "record", side, run: this.#runRequest(state, state.view.size) });
    }
    return (await this.#session.ask<Explained>(b.source, { ask: "explain" })).json;
  }

  /** Handles the progress of a question: received bytes and intermediate pictures. */
  #meanwhile(): (told: Meanwhile) => void {
    let bytes = 0;
    return told => {
      if ("came" in told) return this.#path.came((bytes += told.came));
      this.#sketch(told.sketch, told.rest, "an image that better ones follow");
    };
  }

  #sketch(sketch: Sketch, rest: Uint8Array, about: string): void {
    this.#isDraft = true;
    this.#stage.show(pictures([{ name: "image", about, ...sketch }], rest)[0], undefined);
    const page = document.documentElement.dataset;
    page["sketches"] = String(Number(page["sketches"] ?? 0) + 1);
  }

  /** Requests the cost of each pixel. Adds the cost pictures and enables details under the pointer. */
  async #costs(question: Record<string, unknown>, version: number): Promise<void> {
    this.#busy = true;
    try {
      const { json, rest } = await this.#session.ask<Pick<Told, "pictures">>(this.#source!, { ...question, ask: "costs" });
      if (version === this.#version) {
        this.#results.addPictures(pictures(json.pictures, rest));
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
    return (await this.#session.ask<Pixel | null>(this.#source!, { ask: "pixel", x, y })).json;
  }

  // Display.

  #show({ json, rest, ms, waited }: Answered<Run>, whole: boolean, answered: number, version: number): void {
    const { report } = json;
    const fresh: Picture[] = pictures(json.pictures, rest);
    const name = `${report.machine} \u00b7 ${report.input.name}`;
    document.title = `${name} \u00b7 Basrelief`;
    byId("what").textContent = `${name} \u00b7 ${report.size.width}\u00a0\u00d7\u00a0${report.size.height}`;
    const waiting = waited > 0 ? `, ${waited.toFixed(0)} waiting for the server` : "";
    byId("answered").textContent = `answered in ${answered.toFixed(0)} ms, ${(ms - waited).toFixed(0)} of them computing${waiting}`;
    this.#isDraft = false;
    this.#drafts.settle();
    this.#path.show(json.path, report);
    this.#results.show({ run: json, rest, whole, pictures: fresh, state: copied(this.#state), source: this.#source! });
    this.#tell(whole, answered, version);
  }

  /** Publishes attributes for automated tests: the version of the answer, the time of its first answer, and whether all questions
   *  are answered. */
  #tell(whole: boolean, answered: number, version: number): void {
    const told = document.documentElement.dataset;
    if (told["version"] !== String(version)) told["first"] = answered.toFixed(1);
    told["version"] = String(version);
    told["settled"] = String(whole && version === this.#version);
  }

  #fill(): void {
    fill(this.#state, this.#catalogue, this.#machine, this);
  }

  #parameters(): void {
    parameters(this.#state, this.#machine, this);
  }

  // Events.

  #wire(): void {
    const on = (id: string, event: string, act: (element: HTMLInputElement) => void) =>
      byId(id).addEventListener(event, () => act(byId<HTMLInputElement>(id)));
    const number = (text: string) => (text === "" ? undefined : Number(text));
    on("machine", "change", ({ value }) => {
      Object.assign(this.#state, { machine: value, set: new Map() });
      this.#parameters();
      this.#changed(true, "machine");
    });
    on("demo", "change", ({ value }) => void this.#choose(value));
    on("size", "change", ({ value }) => this.#view({ size: value.split("x").map(Number) }, true));
    on("frames", "change", field => field.reportValidity() && this.#view({ frames: number(field.value) }, true));
    on("orbit", "change", ({ value }) => this.#view({ orbit: number(value) }, true));
    on("light", "input", ({ value }) => this.#view({ light: towards(Number(value)) }, false));
    on("light", "change", ({ value }) => this.#view({ light: towards(Number(value)) }, true));
    on("unlight", "click", () => {
      this.#view({ light: undefined }, true);
      this.#fill();
    });
    on("search", "input", () => this.#parameters());
    on("defaults", "click", () => {
      this.#state.set.clear();
      this.#parameters();
      this.#changed(true, "defaults");
    });
    on("stop", "click", () => {
      this.#halted = true;
      this.#drafts.stop(STOPPED);
      this.client.restart(STOPPED);
      this.#failed(STOPPED);
    });
    on("dismiss", "click", dismissed);
    on("undo", "click", () => history.back());
    on("redo", "click", () => history.forward());
    window.addEventListener("keydown", undoKeys);
    window.addEventListener("popstate", event => void this.#moved(event));
    if (!SERVED) this.#wireFiles(on);
  }

  async #choose(demo: string): Promise<void> {
    const next: State = { ...initial(false), demo, panel: this.#state.panel, view: { size: this.#state.view.size } };
    const source = demo === "" ? undefined : await this.#sourceOf(next);
    if (!source || !(await this.#open(next, source, "input"))) this.#fill();
  }

  #wireFiles(on: (id: string, event: string, act: (element: HTMLInputElement) => void) => void): void {
    on("open", "click", () => byId("files").click());
    on("files", "change", ({ files }) => files && files.length > 0 && void this.#drop(chosen(files)));
    const veil = byId("drop");
    window.addEventListener("dragover", event => {
      event.preventDefault();
      veil.hidden = false;
    });
    window.addEventListener("dragleave", event => event.relatedTarget === null && (veil.hidden = true));
    window.addEventListener("drop", event => {
      event.preventDefault();
      veil.hidden = true;
      if (event.dataTransfer) void this.#drop(dropped(event.dataTransfer));
    });
  }
}

function decoded({ json, rest, ...took }: Answered<Told>): Answered<Run> {
  const text = new TextDecoder().decode(bytesAt(rest, json.report));
  return { json: { ...json, text, report: JSON.parse(text) as Report }, rest, ...took };
}

/** Undo and redo by keys. In text, the keys keep their usual meaning. */
function undoKeys(event: KeyboardEvent): void {
  const isText = (event.target as HTMLElement).matches?.("input:is([type=text], [type=search], [type=number])");
  if (isText || !(event.ctrlKey || event.metaKey) || !["z", "y"].includes(event.key.toLowerCase())) return;
  event.preventDefault();
  byId(event.shiftKey || event.key === "y" ? "redo" : "undo").click();
}
