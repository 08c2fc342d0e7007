// The questions after a change: a quick answer at once, a complete one when the input rests.
import { bytesAt, type Answered } from "./client";
import { byId } from "./dom";
import type { Drafts } from "./drafts";
import type { Path } from "./path";
import { pictures, type Picture } from "./picture";
import { problem, why } from "./problems";
import type { Meanwhile, Pixel, Report, Run, Told } from "./protocol";
import type { Session, Source } from "./session";
import type { State } from "./state";

/** Picture size while the view moves. */
const MOVING: [number, number] = [320, 240];
/** Delay before the complete answer \[ms\]: long enough not to start it between two movements. */
const REST = 200;

/** What questions need of the page. */
export interface Subject {
  /** True if the page is a viewer, which draws the scene of its own server. */
  readonly served: boolean;
  readonly state: State;
  /** The open input; nothing without one. */
  readonly source: Source | undefined;
  /** True while an input is being opened. Meanwhile no run is requested. */
  readonly isOpening: boolean;
  /** Returns machine, parameters and view of a run. */
  runRequest(state: State, size: [number, number]): Record<string, unknown>;
  /** Handles the progress of a question. */
  meanwhile(): (told: Meanwhile) => void;
  show(answer: Answered<Run>, whole: boolean, answered: number, version: number): void;
  addPictures(pictures: Picture[]): void;
  failed(why: string): void;
  /** Called after the last answer. */
  settled(): Promise<void>;
}

export class Questions {
  /** Counts changes. Only the last one gets a complete answer. */
  #version = 0;
  #busy = false;
  /** True from a stop by the user until the next change. */
  #halted = false;
  /** True during a movement. */
  #moving = false;
  /** The version with known pixel costs. */
  #costly = -1;
  #rest: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly subject: Subject, private readonly session: Session, private readonly drafts: Drafts, private readonly path: Path,
  ) {}

  get version(): number {
    return this.#version;
  }

  /** Makes the answers so far old. */
  changed(): void {
    this.#version++;
    this.#halted = false;
  }

  halt(): void {
    this.#halted = true;
  }

  /** Requests a quick answer at once, and a complete one when the input rests. */
  schedule(rests: boolean): void {
    clearTimeout(this.#rest);
    this.#moving = !rests;
    void this.quick();
    this.#rest = setTimeout(() => void this.whole(), rests ? REST / 4 : REST);
  }

  /** Returns the question for a run. */
  question(state: State, size: [number, number], more: Record<string, unknown>): Record<string, unknown> {
    return { ask: "run", ...this.subject.runRequest(state, size), ...more };
  }

  /** Requests a quick answer. During another question it does nothing, because that question's caller asks again afterwards. */
  async quick(): Promise<void> {
    const { state, source, isOpening, served } = this.subject;
    if (this.#busy || this.#halted || isOpening || !source) return;
    const size = state.view.size;
    const small = size[0] * size[1] > MOVING[0] * MOVING[1] ? MOVING : size;
    const version = this.#version;
    const question = this.question(state, small, {});
    const isMoving = this.#moving;
    await this.#run(source, question, false, version, served ? () => this.drafts.now(question, isMoving) : undefined);
    if (version !== this.#version) void this.quick();
  }

  /** Requests the picture in full size, then the comparison with the reference image, then the bottlenecks. */
  async whole(): Promise<void> {
    const version = this.#version;
    if (this.#halted) return;
    if (this.#busy || this.subject.isOpening) {
      clearTimeout(this.#rest);
      this.#rest = setTimeout(() => void this.whole(), 20);
      return;
    }
    const stale = () => version !== this.#version;
    if (await this.#steps(version, stale)) await this.#costs(version);
    if (stale()) return void this.quick();
    if (!this.#halted) await this.subject.settled();
  }

  /** Requests the steps of a complete answer. Returns true if all were answered. */
  async #steps(version: number, stale: () => boolean): Promise<boolean> {
    const { served, state } = this.subject;
    const size = state.view.size;
    const last = { exact: true, limits: true };
    // A server's scene has no reference image, because that needs all texels.
    for (const more of served ? [{}, last] : [{}, { exact: true }, last]) {
      const { source } = this.subject;
      if (stale() || !source) return false;
      const question = this.question(this.subject.state, size, more);
      // A small picture with all its tiles is better than a draft.
      const hides = document.documentElement.dataset["version"] === String(version);
      const ask = served ? () => this.drafts.whole(question, hides, stale) : undefined;
      if (!(await this.#run(source, question, "limits" in more, version, ask))) return false;
    }
    return !stale();
  }

  /** Asks for a run, or lets `ask` do so. Returns true if the run was answered. */
  async #run(
    source: Source, question: Record<string, unknown>, whole: boolean, version: number,
    ask: () => Promise<Answered<Told> | undefined> = () => this.session.ask<Told>(source, question, this.subject.meanwhile()),
  ): Promise<boolean> {
    this.#busy = true;
    const patience = setTimeout(() => {
      byId("stop").hidden = false;
      // A viewer shows how many tiles are here.
      if (!this.subject.served) byId("answered").textContent = "computing\u2026";
    }, 1500);
    try {
      const began = performance.now();
      this.path.begin(version);
      const answer = await ask();
      // Another input may have been opened meanwhile.
      if (!answer || source !== this.subject.source) return false;
      problem("run", undefined);
      this.subject.show(decoded(answer), whole, performance.now() - began, version);
      return true;
    } catch (error) {
      if (version === this.#version) this.subject.failed(why(error));
      return false;
    } finally {
      clearTimeout(patience);
      byId("stop").hidden = true;
      this.#busy = false;
    }
  }

  /** Requests the cost of each pixel. Adds the cost pictures and enables details under the pointer. */
  async #costs(version: number): Promise<void> {
    const { state, source } = this.subject;
    if (!source) return;
    this.#busy = true;
    try {
      const question = { ...this.question(state, state.view.size, {}), ask: "costs" };
      const { json, rest } = await this.session.ask<Pick<Told, "pictures">>(source, question);
      if (version === this.#version) {
        this.subject.addPictures(pictures(json.pictures, rest));
        this.#costly = version;
        document.documentElement.dataset["costs"] = String(version);
      }
    } catch {
      // A run without pixel costs, for example one that ends early, has no such pictures.
    } finally {
      this.#busy = false;
    }
  }

  /** Returns the costs of a pixel; nothing while they are unknown. */
  async pixel(x: number, y: number): Promise<Pixel | null> {
    const { source } = this.subject;
    if (this.#busy || this.#costly !== this.#version || !source) return null;
    return (await this.session.ask<Pixel | null>(source, { ask: "pixel", x, y })).json;
  }
}

/** Reads the report of an answer. */
export function decoded({ json, rest, ...took }: Answered<Told>): Answered<Run> {
  const text = new TextDecoder().decode(bytesAt(rest, json.report));
  return { json: { ...json, text, report: JSON.parse(text) as Report }, rest, ...took };
}
