// The page: its state, its input, and the display of the answers.
import type { Answered, Client } from "./client";
import type { Handlers } from "./controls";
import { byId } from "./dom";
import { Drafts } from "./drafts";
import { wire, wireFiles, type Actions } from "./events";
import type { Dropped } from "./files";
import { fill, parameters, resets, round } from "./form";
import { Path } from "./path";
import { pictures, Stage, type Picture } from "./picture";
import { problem, why } from "./problems";
import type { Catalogue, Explained, Machine, Meanwhile, Run, Sketch, Step, Taken, Told } from "./protocol";
import { decoded, Questions, type Subject } from "./questions";
import { Results, type Kept } from "./results";
import { Session, type Source } from "./session";
import { copied, initial, pinsIn, read, write, type State } from "./state";
import { Steps } from "./steps";
import { keepFiles, keptFiles } from "./stored";

const STOPPED = "Stopped. Change any input to continue.";

/** True if the page is a viewer, which draws the scene of its own server. */
const SERVED = document.documentElement.dataset["from"] !== undefined;

export class Page implements Handlers, Actions, Subject {
  readonly served = SERVED;
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
  #questions: Questions;
  /** True if the image is a draft. */
  #isDraft = false;
  /** Number of inputs that are being opened. */
  #opening = 0;

  constructor(private readonly client: Client) {
    this.#state = read(location.hash, SERVED);
    this.#session = new Session(client, () => {
      this.#path.forget();
      this.#drafts.forget();
    });
    this.#stage = new Stage(byId<HTMLCanvasElement>("picture"), byId<HTMLInputElement>("divider"), byId("caption"), {
      turn: (around, up, rests) => this.#turn(around, up, rests),
      zoom: factor => this.view({ zoom: round(Math.min(100, Math.max(0.01, (this.#state.view.zoom ?? 1) * factor)), 3) }, true),
      reset: () => this.view({ turn: undefined, zoom: undefined }, true),
    }, (x, y) => this.#questions.pixel(x, y));
    this.#drafts = new Drafts({
      ask: (question, body) => this.#session.ask(this.#source!, question, this.meanwhile(), body),
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
        const question = { ...this.#questions.question(state, state.view.size, { cycles: [from, to] }), ask: "steps" };
        return (await this.#session.ask<{ steps: Step[] }>(source, question)).json.steps;
      },
    });
    this.#questions = new Questions(this, this.#session, this.#drafts, this.#path);
  }

  get state(): State {
    return this.#state;
  }

  get source(): Source | undefined {
    return this.#taken && this.#source;
  }

  get isOpening(): boolean {
    return this.#opening > 0;
  }

  /** Draws the first picture, then lists the inputs, then computes the rest. */
  async begin(): Promise<void> {
    this.#results.want(pinsIn(location.hash));
    document.documentElement.dataset["asked"] = String(this.#questions.version);
    if (!(await this.#first(this.#state))) await this.#first(initial(SERVED));
    await this.#questions.quick();
    const { json } = await this.client.ask<Catalogue>({ ask: "catalogue" });
    this.#catalogue = SERVED ? { ...json, machines: json.machines.filter(({ fetches }) => fetches) } : json;
    wire(this);
    if (!SERVED) wireFiles(this);
    this.#fill();
    document.querySelector("main")!.inert = false;
    byId<HTMLDetailsElement>("inputs").open = matchMedia("(min-width: 62rem)").matches;
    void this.#questions.whole();
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

  async drop(files: Promise<Dropped>): Promise<void> {
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
  async moved(event: PopStateEvent): Promise<void> {
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
    this.view({ turn: [round(turned, 1), round(Math.min(90, Math.max(-110, b + up)), 1)] }, rests);
  }

  view(change: Record<string, unknown>, rests: boolean): void {
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
    this.#questions.changed();
    this.#wanted = undefined;
    Object.assign(document.documentElement.dataset, { asked: this.#questions.version, settled: false });
    if (kind === undefined) this.#steps.replace(this.#address());
    else this.#steps.write(this.#address(), kind, rests);
    this.#questions.schedule(rests);
  }

  // Questions.

  runRequest({ set, view, machine }: State, size: [number, number]): Record<string, unknown> {
    return { machine: machine ?? this.#machineName, set: [...set], view: { ...view, size } };
  }

  /** Shows an error, and whose image and results are on the page. */
  failed(reason: string): void {
    const { version } = document.documentElement.dataset;
    const isOld = version !== undefined && version !== String(this.#questions.version);
    const shown = this.#isDraft ? "The command and the results" : "The image, the command and the results";
    byId("answered").textContent = isOld ? `${shown} are those of an earlier view.` : "";
    if (this.#isDraft) this.#stage.rename("a draft of a view that is not complete");
    this.#path.end();
    problem("run", reason);
  }

  /** Runs another state, for example that of a pinned run. */
  async #runOf(state: State, source: Source, more: Record<string, unknown>): Promise<Answered<Run>> {
    return decoded(await this.#session.ask<Told>(source, this.#questions.question(state, state.view.size, more)));
  }

  /** Records two runs again, and returns the causes of their difference. */
  async #explain(a: Kept, b: Kept): Promise<Explained> {
    for (const [side, { state, source }] of [["a", a], ["b", b]] as const) {
      await this.#session.ask(source, { ask: "record", side, run: this.runRequest(state, state.view.size) });
    }
    return (await this.#session.ask<Explained>(b.source, { ask: "explain" })).json;
  }

  /** Handles the progress of a question: received bytes and intermediate pictures. */
  meanwhile(): (told: Meanwhile) => void {
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

  addPictures(more: Picture[]): void {
    this.#results.addPictures(more);
  }

  /** Restores what the address keeps of earlier results. */
  settled(): Promise<void> {
    return this.#results.restore();
  }

  // Display.

  show({ json, rest, ms, waited }: Answered<Run>, whole: boolean, answered: number, version: number): void {
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
    told["settled"] = String(whole && version === this.#questions.version);
  }

  #fill(): void {
    fill(this.#state, this.#catalogue, this.#machine, this);
  }

  #parameters(): void {
    parameters(this.#state, this.#machine, this);
  }

  // Actions of the user.

  chooseMachine(name: string): void {
    Object.assign(this.#state, { machine: name, set: new Map() });
    this.#parameters();
    this.#changed(true, "machine");
  }

  async chooseDemo(demo: string): Promise<void> {
    const next: State = { ...initial(false), demo, panel: this.#state.panel, view: { size: this.#state.view.size } };
    const source = demo === "" ? undefined : await this.#sourceOf(next);
    if (!source || !(await this.#open(next, source, "input"))) this.#fill();
  }

  /** Takes the light of the scene again. */
  resetLight(): void {
    this.view({ light: undefined }, true);
    this.#fill();
  }

  search(): void {
    this.#parameters();
  }

  /** Resets all parameters to their defaults. */
  resetAll(): void {
    this.#state.set.clear();
    this.#parameters();
    this.#changed(true, "defaults");
  }

  stop(): void {
    this.#questions.halt();
    this.#drafts.stop(STOPPED);
    this.client.restart(STOPPED);
    this.failed(STOPPED);
  }
}
