// Tests in Chromium the parts of the page that show and share results: loading, cache, command, report page, comparison, timeline.
//
//   node test/share.mjs PROGRAM PAGE_FOLDER [FOLDER_FOR_PICTURES]
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { QUICK, command, settles, showsInput } from "./actions.mjs";
import { Browser } from "./chromium.mjs";
import { Native, words } from "./native.mjs";

const [program, folder, shots] = process.argv.slice(2);
const native = new Native(program);
const server = await native.serve(folder);
const browser = await Browser.launch();
const opened = (hash, options) => browser.opened(`${server.address}${hash}`, options);

/** Serves the page with the simulator in small pieces, and holds it back until `release` is called. */
async function slowly() {
  let release;
  const held = new Promise(done => (release = done));
  const slow = createServer(async (request, answer) => {
    const name = new URL(request.url, "http://x").pathname.slice(1) || "index.html";
    const kinds = { html: "text/html", css: "text/css", js: "text/javascript", wasm: "application/wasm" };
    answer.setHeader("content-type", kinds[name.split(".").at(-1)] ?? "text/plain");
    const bytes = readFileSync(join(folder, name));
    if (!name.endsWith(".wasm")) return answer.end(bytes);
    answer.write(bytes.subarray(0, 1_000_000));
    await held;
    answer.end(bytes.subarray(1_000_000));
  });
  await new Promise(done => slow.listen(0, "127.0.0.1", done));
  return { address: `http://127.0.0.1:${slow.address().port}/`, release, stop: () => (slow.closeAllConnections(), slow.close()) };
}

async function loadingShowsBytesAndDisablesControls() {
  const slow = await slowly();
  const context = await browser.chromium.newContext();
  const page = await context.newPage();
  // Notes the order in which pictures and controls appear.
  await page.addInitScript(() => {
    globalThis.order = [];
    const put = CanvasRenderingContext2D.prototype.putImageData;
    CanvasRenderingContext2D.prototype.putImageData = function (...all) {
      globalThis.order.push("picture");
      return put.apply(this, all);
    };
    new MutationObserver(() => document.querySelector("#controls > *") && globalThis.order.push("controls"))
      .observe(document, { childList: true, subtree: true });
  });
  await page.goto(slow.address);
  await page.waitForFunction(() => document.getElementById("loading").value >= 1_000_000);
  assert.match(await page.textContent("#answered"), /1,000,000 of \d,\d{3},\d{3} bytes/);
  assert.ok(await page.evaluate(() => document.querySelector("main").inert), "controls are disabled");
  slow.release();
  await page.waitForFunction(() => document.documentElement.dataset.settled === "true");
  assert.ok(await page.evaluate(() => !document.querySelector("main").inert && document.getElementById("loading").hidden));
  assert.deepEqual((await page.evaluate(() => globalThis.order)).filter((what, n, all) => what !== all[n - 1]).slice(0, 2), ["picture", "controls"]);
  await context.close();
  slow.stop();
}

async function simulatorComesFromTheCache() {
  const page = await opened(QUICK);
  await page.evaluate(async () => {
    await navigator.serviceWorker.ready;
    while (!(await (await caches.open("basrelief.wasm")).keys()).length) await new Promise(done => setTimeout(done, 50));
  });
  const loads = [];
  page.on("response", response => response.url().includes(".wasm") && loads.push(response.fromServiceWorker()));
  await page.reload();
  await browser.whole(page);
  assert.deepEqual(loads, [true]);
  // The network is not asked for it: the cached bytes are enough.
  await page.context().route("**/*.wasm*", route => route.abort());
  await page.reload();
  await browser.whole(page);
  await page.close();
}

async function commandIsCopied() {
  const page = await opened(QUICK);
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.click("#pin");
  await page.focus('[id="slide-replacement.lanes"]');
  await page.keyboard.press("Home");
  await settles(page, "--set replacement.lanes=1");
  await page.click("#copy");
  await page.waitForFunction(() => document.getElementById("copy").textContent === "Copied");
  assert.equal(await page.evaluate(() => navigator.clipboard.readText()), await command(page));
  // Each pinned run has its own command.
  await page.click("#pins button:has-text('Copy')");
  await page.waitForFunction(() => document.querySelector("#pins button").textContent === "Copied");
  assert.equal(await page.evaluate(() => navigator.clipboard.readText()), "basrelief demo cut-plane@1 --machine bump --size 160x120");
  await page.close();
}

/** Returns the output of the program in a temporary folder, and a file from there. */
function ran(lines, file) {
  const cwd = mkdtempSync(join(tmpdir(), "basrelief-share-"));
  try {
    const outputs = lines.map(line => execFileSync(native.program, line, { cwd, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] }));
    return { last: outputs.at(-1), text: file && readFileSync(join(cwd, file), "utf8") };
  } finally {
    rmSync(cwd, { recursive: true });
  }
}

/** The saved page has the sections of the page that the program writes. */
async function savedPageEqualsTheNativePage() {
  const page = await opened(QUICK);
  for (const demo of ["golf-ball", "corridor"]) {
    await page.evaluate(hash => (location.hash = hash), `#demo=${demo}&size=160x120`);
    await showsInput(page, demo);
    await browser.whole(page);
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("#export")]);
    const saved = readFileSync(await download.path(), "utf8");
    const { text } = ran([[...words(await command(page)).slice(1), "--quiet", "--html", "report.html"]], "report.html");
    // A page without a policy reads them, because a parsed style counts as a style of the reading page.
    const reader = await browser.chromium.newPage();
    const [ours, theirs] = await reader.evaluate(pages => pages.map(html => {
      const of = new DOMParser().parseFromString(html, "text/html");
      const sections = [...of.querySelectorAll("main > section")].map(section => [section.id, section.id === "pictures" ? "" : section.innerHTML.replace(/<.h2>\s*/, "</h2>").trim()]);
      const figures = [...of.querySelectorAll("header dd, header dt")].map(of => of.textContent);
      const policy = of.querySelector("meta[http-equiv]").content;
      return { sections, figures, policy, pictures: of.querySelectorAll("#pictures img").length, title: of.title };
    }), [saved, text]);
    await reader.close();
    assert.deepEqual(ours, theirs);
    assert.ok(!saved.includes("<script") && saved.includes("--busy"), "it has the style of reports, and no script");
  }
  await page.close();
}

/** One click compares two pinned runs, and the causes add up to the difference. */
async function comparisonExplainsTheDifference() {
  for (const [demo, a, b] of [
    ["corridor", "", "set=memory.texture.part%3Dsdr-100&set=texel.error_bound%3D0.25"],
    ["golf-ball", "set=fifo.fragments.depth%3D4&set=replacement.lanes%3D16", "turn=20,0&set=memory.graphics.part%3Dsdr-100"],
  ]) {
    const page = await opened(`#demo=${demo}&size=160x120&${a}`);
    await page.click("#pin");
    const first = await command(page);
    await page.evaluate(hash => (location.hash = hash), `#demo=${demo}&size=160x120&${b}&pin=${encodeURIComponent(new URLSearchParams(new URL(page.url()).hash.slice(1)).get("pin"))}`);
    await page.waitForFunction(before => document.getElementById("command").textContent !== before, first);
    await browser.whole(page);
    await page.click("#pin");
    await page.click("#compare");
    await page.waitForSelector("#explained");
    const told = await page.textContent("#explained .lead");
    const run = (line, out) => [...words(line).slice(1), "--quiet", "--out", out];
    const { last } = ran([run(first, "a"), run(await command(page), "b"), ["compare", "a", "b", "--json"]]);
    // The words are those of the program, whose recordings have the causes of the same runs.
    assert.equal(told, JSON.parse(last).explanation);
    const [head] = told.match(/^.* %\)/);
    const causes = await page.locator("#explained td.right").allTextContents();
    const signed = causes.map(text => Number(text.replaceAll(",", "").replace("\u2212", "-")));
    const [, count, sign] = head.match(/B takes ([\d,]+) (more|fewer)/);
    assert.ok(signed.length >= 3, "each changed parameter and the interaction have a row");
    assert.equal(signed.reduce((all, n) => all + n, 0), Number(count.replaceAll(",", "")) * (sign === "more" ? 1 : -1));
    console.log(told);
    await page.close();
  }
}

async function timelineZoomsAndMoves() {
  const page = await opened(`${QUICK}&show=timeline`);
  const cycles = async () => (await page.textContent("#shown-cycles")).match(/[\d,]+/g).slice(0, 2).map(n => Number(n.replaceAll(",", "")));
  const all = await cycles();
  await page.focus("#time-strips");
  await page.keyboard.press("+");
  await page.keyboard.press("+");
  const near = await cycles();
  assert.ok(Math.abs((near[1] - near[0]) * 4 / (all[1] - all[0]) - 1) < 0.02, `${near} of ${all}`);
  await page.keyboard.press("ArrowRight");
  const later = await cycles();
  assert.ok(later[0] > near[0] && later[1] > near[1]);
  // A drag moves the timeline, and the pointer reads the column below it.
  const box = await page.locator("#time-strips canvas").first().boundingBox();
  await page.mouse.move(box.x + 50, box.y + 5);
  await page.mouse.down();
  await page.mouse.move(box.x + 150, box.y + 5, { steps: 3 });
  await page.mouse.up();
  const dragged = await cycles();
  assert.ok(dragged[0] < later[0]);
  const [from] = (await page.textContent("#panel > p")).match(/(?<=cycles )[\d,]+/).map(n => Number(n.replaceAll(",", "")));
  assert.ok(from >= dragged[0] && from <= dragged[1], `${from} in ${dragged}`);
  await page.click("#time-Home");
  assert.deepEqual(await cycles(), all);
  await page.close();
}

/** Returns what each strip shows at these cycles: text, and whether its colour is that of the state in the text. */
const stripsAt = (page, cycles) => page.evaluate(cycles => {
  const [from, to] = document.getElementById("shown-cycles").textContent.match(/[\d,]+/g).map(n => Number(n.replaceAll(",", "")));
  return [...document.querySelectorAll("#time-strips canvas")].map(canvas => {
    const [box, style] = [canvas.getBoundingClientRect(), getComputedStyle(canvas)];
    const copy = new OffscreenCanvas(canvas.width, 1).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, -14);
    const row = copy.getImageData(0, 0, canvas.width, 1).data;
    return cycles.map(cycle => {
      const at = (cycle + 0.5 - from) / (to - from);
      canvas.dispatchEvent(new PointerEvent("pointermove", { clientX: box.left + at * box.width }));
      const text = document.querySelector("#panel > p").textContent;
      const pixel = 4 * Math.floor(at * canvas.width);
      const shown = [...row.slice(pixel, pixel + 3)].map(n => n.toString(16).padStart(2, "0"));
      const state = text.match(/: (busy|memory|starved|blocked): /)?.[1];
      return { text, isColoured: `#${shown.join("")}` === style.getPropertyValue(`--${state}`).trim() };
    });
  });
}, cycles);

/** Compares the steps in a column of cycles with the share of the column, which comes from another computation. */
async function stepsAddUpToColumns(page) {
  await page.focus("#time-strips");
  await page.keyboard.press("-");
  await page.keyboard.press("-");
  const caption = () => page.textContent("#shown-cycles");
  const [from, to] = (await caption()).match(/[\d,]+/g).slice(0, 2).map(n => Number(n.replaceAll(",", "")));
  await page.waitForFunction(([from, to]) => {
    const [first, end] = document.documentElement.dataset.steps.split(" ").map(Number);
    return first <= from && end >= to;
  }, [from, to]);
  const width = 128;
  const first = Math.ceil(from / width) * width;
  assert.ok(first + width <= to, `${from} to ${to} holds a column of ${width}`);
  const strips = await stripsAt(page, Array.from({ length: width }, (_, n) => first + n));
  for (const { text, isColoured } of strips.flat()) assert.ok(isColoured || !/: (busy|memory|starved|blocked): /.test(text), text);
  while (!(await caption()).includes("per column")) await page.keyboard.press("-");
  assert.ok((await caption()).endsWith(` ${width} per column`), await caption());
  const columns = await stripsAt(page, [first]);
  columns.forEach(([{ text }], n) => {
    const busy = Number(text.match(/busy (\d+) %/)?.[1] ?? 0);
    const steps = (100 * strips[n].filter(({ text }) => text.includes(": busy: ")).length) / width;
    assert.ok(Math.abs(busy - steps) <= 1, `${text}, but the steps are busy ${steps.toFixed(1)} %`);
  });
}

/** Tests the steps at the resolution of single cycles: they are requested when the view is near, and the pointer shows the arguments. */
async function timelineShowsSingleSteps() {
  const page = await opened("#demo=golf-ball&size=160x120&show=timeline");
  const caption = () => page.textContent("#shown-cycles");
  assert.equal(await page.getAttribute("html", "data-steps"), null, "steps are listed on demand alone");
  await page.focus("#time-strips");
  while (!(await caption()).includes("each step")) await page.keyboard.press("+");
  for (let n = 0; n < 4; n++) await page.keyboard.press("+");
  await page.waitForFunction(() => document.documentElement.dataset.steps !== undefined);
  const [from, to] = (await caption()).match(/[\d,]+/g).slice(0, 2).map(n => Number(n.replaceAll(",", "")));
  assert.ok(to - from <= 128, `${from} to ${to}`);
  const texts = new Set();
  for (const strip of await page.locator("#time-strips canvas").all()) {
    const box = await strip.boundingBox();
    for (let at = 0.01; at < 1; at += 0.02) {
      await page.mouse.move(box.x + at * box.width, box.y + 5);
      texts.add(await page.textContent("#panel > p"));
    }
  }
  const numbers = text => text.match(/cycles ([\d,]+) to ([\d,]+)/).slice(1).map(n => Number(n.replaceAll(",", "")));
  for (const text of texts) assert.ok(numbers(text)[0] < to && numbers(text)[1] > from, text);
  assert.ok([...texts].some(text => numbers(text)[1] - numbers(text)[0] === 1), "a step of one cycle is seen");
  assert.ok([...texts].some(text => /: busy: frame 1, .*polygon \d+.*pixels? at \d+,\d+/.test(text)), [...texts].slice(0, 9).join("\n"));
  await stepsAddUpToColumns(page);
  console.log(`${texts.size} steps between ${from} and ${to}, for example: ${[...texts].find(text => text.includes("pixel"))}`);
  if (shots) await page.screenshot({ path: `${shots}/steps.png` });
  await page.close();
}

async function tabsAreFiveGroups() {
  const page = await opened(`${QUICK}&show=memories`);
  assert.equal(await page.locator("#tabs button").count(), 5);
  for (const width of [390, 1400]) {
    await page.setViewportSize({ width, height: 900 });
    const rows = new Set(await page.locator("#tabs button").evaluateAll(all => all.map(tab => tab.getBoundingClientRect().top)));
    assert.equal(rows.size, 1, `${width}: they are in one row`);
  }
  // An address may name a section of a group.
  assert.equal(await page.getAttribute("#tab-diagram", "aria-selected"), "true");
  const sections = [];
  for (const tab of await page.locator("#tabs button").all()) {
    await tab.click();
    sections.push(...await page.locator("#panel > section").evaluateAll(all => all.map(({ id }) => id)));
  }
  const { text } = ran([[...words(await command(page)).slice(1), "--quiet", "--html", "report.html"]], "report.html");
  const expected = [...text.matchAll(/<section id="(\w+)"/g)].map(([, id]) => id).filter(id => id !== "pictures" && id !== "warnings");
  assert.deepEqual(sections.toSorted(), expected.toSorted(), "every section of the report is in a group");
  await page.close();
}

try {
  for (const test of [
    loadingShowsBytesAndDisablesControls, simulatorComesFromTheCache, commandIsCopied, savedPageEqualsTheNativePage,
    comparisonExplainsTheDifference, timelineZoomsAndMoves, timelineShowsSingleSteps, tabsAreFiveGroups,
  ]) {
    await test();
    console.log(`ok: ${test.name}`);
  }
  assert.deepEqual(browser.faults, []);
} finally {
  await browser.close();
  server.stop();
}
