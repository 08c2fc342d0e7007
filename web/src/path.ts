// Bytes received from the server: the total, compared with the bytes of all whole textures, and the part for the current view.
import { byId, percent, thousands } from "./dom";
import type { Come, Report } from "./protocol";

const NOTHING: Come = { requests: 0, scene_bytes: 0, tiles: 0, tile_bytes: 0 };

export class Path {
  /** Totals received before the current view, and up to now. */
  #before = NOTHING;
  #come = NOTHING;
  #view = -1;
  /** True while bytes of the current view arrive. */
  #isComing = false;
  /** Bytes of all tiles of all textures, once known. */
  #all = 0;

  /** Resets the counts after a restart of the simulator. */
  forget(): void {
    this.#before = this.#come = NOTHING;
  }

  /** Starts the counts of a view. Each view has its own number. */
  begin(view: number): void {
    if (view === this.#view) return;
    this.#view = view;
    this.#before = this.#come;
  }

  /** Adds bytes received since the last answer and not yet checked. They belong to the current view, as do the bytes of its
   *  answers so far. */
  came(bytes: number): void {
    const all = this.#come.tile_bytes + bytes;
    this.#bar(all);
    this.#isComing = true;
    byId("path-view").textContent = `This view: ${thousands(all - this.#before.tile_bytes)} bytes received so far\u2026`;
  }

  /** Shows that no further bytes of the current view will arrive. */
  end(): void {
    if (!this.#isComing) return;
    this.#isComing = false;
    const view = byId("path-view");
    view.textContent = (view.textContent ?? "").replace(" so far\u2026", ". It is not complete.");
  }

  #bar(bytes: number): void {
    byId("path-share").style.width = percent(Math.min(bytes, this.#all), this.#all).replace(" ", "");
  }

  show(come: Come | null, report: Report): void {
    if (!come) return;
    this.#come = come;
    this.#isComing = false;
    const all = report.figures["conventional_tile_bytes"] ?? 0;
    this.#all = all;
    this.#bar(come.tile_bytes);
    byId("path-all").textContent = `Received ${thousands(come.tile_bytes)} of ${thousands(all)} bytes of all texture tiles `
      + `(${percent(come.tile_bytes, all)}). The scene without textures took ${thousands(come.scene_bytes)} bytes.`;
    const [tiles, bytes] = [come.tiles - this.#before.tiles, come.tile_bytes - this.#before.tile_bytes];
    const rest = this.#before.tiles === 0 ? "" : tiles > 0 ? "; the other tiles were already here" : "; all tiles were already here";
    byId("path-view").textContent = `This view: ${thousands(bytes)} bytes, in ${thousands(tiles)} tiles${rest}.`;
  }
}
