// Tests with axe-core in Chromium that nothing keeps users of keyboards and screen readers out: the page with each of its tabs, the
// viewer, the page of a report and the page of a sweep, at three widths, in light and dark.
//
//   node test/accessible.mjs PROGRAM PAGE_FOLDER SWEEP_PAGE
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { QUICK } from "./actions.mjs";
import { Browser } from "./chromium.mjs";
import { Native } from "./native.mjs";

const [program, folder, sweep] = process.argv.slice(2);
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const native = new Native(program);
const browser = await Browser.launch();
const out = mkdtempSync(join(tmpdir(), "basrelief-axe-"));
const found = [];

/** The rules whose results depend on colours. The others find the same in dark as in light. */
const OF_COLOURS = { runOnly: ["color-contrast", "link-in-text-block"] };

/** Collects the violations on a page or in a part of it in each form, with all collapsed blocks open. */
async function check(page, name, part = "html") {
  await page.evaluate(part => document.querySelectorAll(`${part} details`).forEach(details => (details.open = true)), part);
  for (const [colorScheme, rules] of [["light", {}], ["dark", OF_COLOURS]]) {
    for (const width of [390, 820, 1400]) {
      await page.emulateMedia({ colorScheme });
      await page.setViewportSize({ width, height: 900 });
      const options = { resultTypes: ["violations"], ...rules };
      const { violations } = await page.evaluate(([part, options]) => globalThis.axe.run(part, options), [part, options]);
      for (const { id, nodes } of violations) {
        const [{ target, any, all, none }] = nodes;
        const why = [...any, ...all, ...none][0]?.message;
        found.push(`${name}, ${colorScheme}, ${width}: ${id}, ${nodes.length} times, first at ${target.join(" ")}: ${why}`);
      }
    }
  }
}

async function opened(address) {
  const page = await browser.chromium.newPage({ bypassCSP: true });
  await page.goto(address);
  await page.evaluate(axe);
  return page;
}

/** Checks the simulator with pinned and compared runs, in each of its tabs. */
async function simulator(page, name) {
  await browser.whole(page);
  await page.click("#pin");
  await page.selectOption("#right", { index: 1 });
  await page.click("#compare");
  await page.waitForSelector("#explained");
  await check(page, name);
  // The check of the page has included the selected tab.
  for (const id of await page.locator("#tabs button[aria-selected=false]").evaluateAll(all => all.map(({ id }) => id))) {
    const tab = page.locator(`#${id}`);
    await tab.click();
    await check(page, `${name}, ${await tab.textContent()}`, "#panel");
  }
}

try {
  execFileSync(native.program, ["demo", "coin", "--size", "64x48", "--frames", "2", "--html", join(out, "report.html"), "--quiet"]);
  await check(await opened(pathToFileURL(join(out, "report.html")).href), "report");
  await check(await opened(pathToFileURL(resolve(sweep)).href), "sweep");
  for (const [name, model] of [["page"], ["viewer", "demo:cut-plane@1"]]) {
    const server = await native.serve(folder, model);
    try {
      await simulator(await opened(`${server.address}${model ? "#size=160x120" : QUICK}`), name);
    } finally {
      await server.stop();
    }
  }
  assert.deepEqual(found, []);
  console.log("accessible: page, viewer, report and sweep, at three widths, light and dark");
} finally {
  await browser.close();
  rmSync(out, { recursive: true });
}
