// What has come from the server, against what would come with all textures whole; and what of it was for this view.
import { byId, percent, thousands } from "./dom";
import type { Come, Report } from "./protocol";

const NOTHING: Come = { requests: 0, scene_bytes: 0, tiles: 0, tile_bytes: 0 };

export class Path {
  /** What had come before this view, and what has come. */
  #before = NOTHING;
  #come = NOTHING;
  #view = -1;
  /** What all tiles of all textures take, once that is known. */
  #all = 0;

  /** The simulator has begun anew: nothing has come. */
  forget(): void {
    this.#before = this.#come = NOTHING;
  }

  /** Something of this view is asked for: a number of its own. */
  begin(view: number): void {
    if (view === this.#view) return;
    this.#view = view;
    this.#before = this.#come;
  }

  /** Bytes that have come since the last answer, and are not checked yet: they are of this view, as what came for its answers so far. */
  came(bytes: number): void {
    const all = this.#come.tile_bytes + bytes;
    this.#bar(all);
    byId("path-view").textContent = `This view: ${thousands(all - this.#before.tile_bytes)} bytes received so far\u2026`;
  }

  #bar(bytes: number): void {
    byId("path-share").style.width = percent(Math.min(bytes, this.#all), this.#all).replace(" ", "");
  }

  show(come: Come | null, report: Report): void {
    if (!come) return;
    this.#come = come;
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
