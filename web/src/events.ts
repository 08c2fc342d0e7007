// The controls of the page, and what each does.
import { byId } from "./dom";
import { chosen, dropped, type Dropped } from "./files";
import { towards } from "./form";
import { dismissed } from "./problems";

/** What the user can do. `rests` is false during a movement. */
export interface Actions {
  chooseMachine(name: string): void;
  chooseDemo(name: string): Promise<void>;
  view(change: Record<string, unknown>, rests: boolean): void;
  resetLight(): void;
  /** Lists the parameters that match the search. */
  search(): void;
  resetAll(): void;
  stop(): void;
  /** Opens dropped or chosen files. */
  drop(files: Promise<Dropped>): Promise<void>;
  /** Follows a move in the history. */
  moved(event: PopStateEvent): Promise<void>;
}

function on(id: string, event: string, act: (element: HTMLInputElement) => void): void {
  byId(id).addEventListener(event, () => act(byId<HTMLInputElement>(id)));
}

const number = (text: string): number | undefined => (text === "" ? undefined : Number(text));

/** Connects all controls but those for files. */
export function wire(page: Actions): void {
  on("machine", "change", ({ value }) => page.chooseMachine(value));
  on("demo", "change", ({ value }) => void page.chooseDemo(value));
  on("size", "change", ({ value }) => page.view({ size: value.split("x").map(Number) }, true));
  on("frames", "change", field => field.reportValidity() && page.view({ frames: number(field.value) }, true));
  on("orbit", "change", ({ value }) => page.view({ orbit: number(value) }, true));
  on("light", "input", ({ value }) => page.view({ light: towards(Number(value)) }, false));
  on("light", "change", ({ value }) => page.view({ light: towards(Number(value)) }, true));
  on("unlight", "click", () => page.resetLight());
  on("search", "input", () => page.search());
  on("defaults", "click", () => page.resetAll());
  on("stop", "click", () => page.stop());
  on("dismiss", "click", dismissed);
  on("undo", "click", () => history.back());
  on("redo", "click", () => history.forward());
  window.addEventListener("keydown", undoKeys);
  window.addEventListener("popstate", event => void page.moved(event));
}

/** Connects what opens files. */
export function wireFiles(page: Actions): void {
  on("open", "click", () => byId("files").click());
  on("files", "change", ({ files }) => files && files.length > 0 && void page.drop(chosen(files)));
  const veil = byId("drop");
  window.addEventListener("dragover", event => {
    event.preventDefault();
    veil.hidden = false;
  });
  window.addEventListener("dragleave", event => event.relatedTarget === null && (veil.hidden = true));
  window.addEventListener("drop", event => {
    event.preventDefault();
    veil.hidden = true;
    if (event.dataTransfer) void page.drop(dropped(event.dataTransfer));
  });
}

/** Undo and redo by keys. In text, the keys keep their usual meaning. */
function undoKeys(event: KeyboardEvent): void {
  const isText = (event.target as HTMLElement).matches?.("input:is([type=text], [type=search], [type=number])");
  if (isText || !(event.ctrlKey || event.metaKey) || !["z", "y"].includes(event.key.toLowerCase())) return;
  event.preventDefault();
  byId(event.shiftKey || event.key === "y" ? "redo" : "undo").click();
}
