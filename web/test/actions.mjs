// Actions of a user for the tests of the page.
import { readFileSync } from "node:fs";
import { basename } from "node:path";

/** Addresses of scenes that two devices simulate fast, for tests that need no particular scene. */
export const QUICK = "#demo=cut-plane@1&machine=bump&size=160x120";
export const QUICK_SHADE = "#demo=goblet@1&size=160x120";

/** Drops files onto the page: names with contents, or paths. */
export async function drop(page, ...files) {
  const contents = files.map(file => (typeof file === "string" ? [basename(file), readFileSync(file)] : file));
  await page.evaluate(files => {
    const transfer = new DataTransfer();
    for (const [name, bytes] of files) transfer.items.add(new File([Uint8Array.from(atob(bytes), c => c.charCodeAt(0))], name));
    window.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, cancelable: true }));
  }, contents.map(([name, bytes]) => [name, Buffer.from(bytes).toString("base64")]));
}

/** Waits until the page shows this input. */
export const showsInput = (page, name) => page.waitForFunction(name => document.getElementById("what").textContent.includes(name), name);

export const problem = page => page.textContent("#problem p");
export const command = page => page.textContent("#command");

/** Waits until the command ends like this, with all questions answered. */
export async function settles(page, end) {
  await page.waitForFunction(end => document.getElementById("command").textContent.endsWith(end)
    && document.documentElement.dataset.settled === "true", end);
}

/** Returns the path of each tile that a request is for. */
export const tilesOf = path => path.split("/").at(-1).split(",").map(number => path.replace(/[^/]*$/, number));
