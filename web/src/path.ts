// What has come from the server, against what would come with all textures whole; and what of it was for this view.
import { byId, percent, thousands } from "./dom";
import type { Come, Report } from "./protocol";

const NOTHING: Come = { requests: 0, scene_bytes: 0, tiles: 0, tile_bytes: 0 };

export class Path {
  /** What had come before this view, and what has come. */
  #before = NOTHING;
  #come = NOTHING;
  #view = -1;

  /** Something of this view is asked for: a number of its own. */
  begin(view: number): void {
    if (view === this.#view) return;
    this.#view = view;
    this.#before = this.#come;
  }

  /** Bytes come, and are not checked yet. */
  came(bytes: number): void {
    byId("path-view").textContent = `This view: fetching\u2026 ${thousands(bytes)} bytes have come.`;
  }

  show(come: Come | null, report: Report): void {
    if (!come) return;
    this.#come = come;
    const all = report.figures["conventional_tile_bytes"] ?? 0;
    byId("path-share").style.width = percent(Math.min(come.tile_bytes, all), all).replace(" ", "");
    byId("path-all").textContent = `Fetched ${thousands(come.tile_bytes)} of the ${thousands(all)} bytes that all tiles of all textures `
      + `take: ${percent(come.tile_bytes, all)}. The scene without texels took ${thousands(come.scene_bytes)} more.`;
    const [tiles, bytes] = [come.tiles - this.#before.tiles, come.tile_bytes - this.#before.tile_bytes];
    const rest = this.#before.tiles === 0 ? "" : tiles > 0 ? "; what it needs besides had come before" : "; all that it needs had come before";
    byId("path-view").textContent = `This view: ${thousands(bytes)} bytes, in ${thousands(tiles)} tiles${rest}.`;
  }
}
