// Tests the pages of reports in Chromium: the demo of each machine at the widths of a screen, a tablet and a phone.
//
//   node web/test/report.mjs PROGRAM [FOLDER_FOR_PICTURES]
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { Browser } from "./chromium.mjs";

const [program, shots] = process.argv.slice(2);
const browser = await Browser.launch();
const out = mkdtempSync(join(tmpdir(), "basrelief-report-"));

/** Returns parts that the window cuts off: all that lie beyond its edge, except in regions that keys and fingers scroll. */
function cutOff() {
  const isReached = part => part.closest("details:not([open])") || part.closest(".wide[tabindex='0']");
  const parts = [...document.querySelectorAll("body *")].filter(part => !isReached(part) || part.matches(".wide"));
  const beyond = parts.filter(part => {
    const { left, right, width } = part.getBoundingClientRect();
    return width > 0 && (left < -1 || right > innerWidth + 1);
  });
  return [...beyond.map(part => part.outerHTML.slice(0, 120)), ...(document.documentElement.scrollWidth > innerWidth ? ["page"] : [])];
}

/** Returns the words in tables of bars that take more than one line. */
function brokenWords() {
  const broken = [];
  for (const cell of document.querySelectorAll(".bars :is(th, td)")) {
    const texts = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
    while (texts.nextNode()) {
      for (const { index, 0: word } of texts.currentNode.data.matchAll(/[^\s._-]+/g)) {
        const range = document.createRange();
        range.setStart(texts.currentNode, index);
        range.setEnd(texts.currentNode, index + word.length);
        if (range.getClientRects().length > 1) broken.push(word);
      }
    }
  }
  return broken;
}

/** Returns the tables of bars that scroll sideways, and those whose bars leave a third of their table empty or have no height. */
function poorBars() {
  const tables = [...document.querySelectorAll(".bars .wide")];
  const scrolled = tables.filter(table => table.scrollWidth > table.clientWidth);
  const narrow = tables.filter(table => {
    const { width, height } = table.querySelector(".bar").getBoundingClientRect();
    return height < 5 || (innerWidth < 640 && width < 0.9 * table.clientWidth);
  });
  return [...scrolled, ...narrow].map(table => table.getAttribute("aria-label"));
}

try {
  for (const demo of ["golf-ball", "goblet", "corridor", "gallery"]) {
    const file = join(out, `${demo}.html`);
    execFileSync(program, ["demo", demo, "--size", "160x120", "--out", join(out, demo), "--html", file, "--quiet"]);
    const page = await browser.chromium.newPage();
    await page.goto(pathToFileURL(file).href);
    for (const colorScheme of ["light", "dark"]) {
      for (const width of [1400, 820, 390]) {
        await page.emulateMedia({ colorScheme });
        await page.setViewportSize({ width, height: 900 });
        const where = `${demo}, ${width} pixels`;
        for (const fault of [cutOff, brokenWords, poorBars]) assert.deepEqual(await page.evaluate(fault), [], `${where}: ${fault.name}`);
        // The drawing is as wide as the page, or wider and scrolled.
        const [drawing, place] = await page.$eval(".blocks", drawing => [drawing.getBoundingClientRect().width, drawing.parentElement.clientWidth]);
        assert.ok(drawing >= place - 1, `${where}: the block diagram takes ${drawing} of ${place} pixels`);
        assert.ok(await page.locator(".blocks .limit").count() > 0, `${where}: the bottleneck is marked`);
        if (shots) await page.screenshot({ path: join(shots, `report-${demo}-${width}-${colorScheme}.png`), fullPage: true });
      }
    }
    await page.close();
  }
  assert.deepEqual(browser.faults, []);
  console.log("reports: nothing cut off, no word broken, bars and block diagrams as wide as the page");
} finally {
  await browser.close();
  rmSync(out, { recursive: true });
}
