// Tests the page in Chromium with user actions.
//
//   node test/browser.mjs PROGRAM PAGE_FOLDER [MODEL...]
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { basename, dirname, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { QUICK, QUICK_SHADE, drop, showsInput } from "./actions.mjs";
import { Browser } from "./chromium.mjs";
import { Native } from "./native.mjs";

const [program, folder, ...models] = process.argv.slice(2);
const native = new Native(program);
const server = await native.serve(folder);
const browser = await Browser.launch();
const { faults } = browser;
const opened = address => browser.opened(address);
const whole = page => browser.whole(page);
const shown = page => browser.shown(page);

async function equalsNative(page, where) {
  const { report, command } = await shown(page);
  assert.deepEqual(report, native.report(command, where), command);
  console.log(`equal: ${command}: ${report.cycles.total} cycles, picture ${report.image.at(-1).sha256.slice(0, 12)}`);
}

async function machines() {
  const page = await opened(`${server.address}${QUICK}`);
  // The coin has other tables of brightness in each frame.
  for (const demo of ["golf-ball", "coin&frames=2", "goblet", "corridor", "gallery"]) {
    await page.evaluate(hash => (location.hash = hash), `#demo=${demo}&size=160x120`);
    await showsInput(page, demo.split("&")[0]);
    await whole(page);
    await equalsNative(page);
    assert.ok((await page.locator("#panel svg").count()) > 3, "bars of the units");
    for (const tab of await page.locator("#tabs button").all()) {
      await tab.click();
      assert.ok((await page.textContent("#panel")).length > 20, await tab.textContent());
    }
  }
  await page.close();
}

/** Measures the time from a slider movement to the new picture and figures. */
async function slider() {
  const page = await opened(`${server.address}#demo=golf-ball&size=320x240`);
  const slide = page.locator('[id="slide-replacement.lanes"]');
  const before = await page.textContent("#numbers dd");
  const times = [];
  await slide.focus();
  for (let n = 0; n < 12; n++) {
    await page.keyboard.press(n < 6 ? "ArrowLeft" : "ArrowRight");
    await page.waitForFunction(() => document.documentElement.dataset.version === document.documentElement.dataset.asked);
    times.push(Number(await page.evaluate(() => document.documentElement.dataset.first)));
  }
  times.sort((a, b) => a - b);
  console.log(`slider to answer at 320 x 240: median ${times[6].toFixed(0)} ms, ${times[0].toFixed(0)} to ${times[11].toFixed(0)} ms`);
  await slide.press("Home");
  await whole(page);
  assert.notEqual(await page.textContent("#numbers dd"), before);
  assert.match(await page.textContent("#command"), /--set replacement\.lanes=1$/);
  await equalsNative(page);
  await page.close();
}

/** Tests what the page says about several frames: the quality of the worst one, and the images of the last one. */
async function severalFrames() {
  const page = await opened(`${server.address}${QUICK}&frames=2&orbit=200`);
  assert.match(await page.textContent("#caption"), /the machine's image, frame 2 of 2\./);
  const { report } = await shown(page);
  const numbers = await page.textContent("#numbers");
  const worst = `dB against reference images, worst frame${report.quality.min.psnr_db.toFixed(2)}`;
  assert.ok(report.quality.min.psnr_db < report.quality.psnr_db && numbers.includes(worst), `${worst} in ${numbers}`);
  await page.close();
}

async function turned() {
  const page = await opened(`${server.address}${QUICK}&frames=2`);
  await page.focus("#picture");
  for (const key of ["ArrowRight", "ArrowUp", "+"]) await page.keyboard.press(key);
  await whole(page);
  assert.match(await page.textContent("#command"), /--size 160x120 --turn 10,10 --zoom 1\.25 --frames 2$/);
  await equalsNative(page);
  await page.locator("#picture").scrollIntoViewIfNeeded();
  const box = await page.locator("#picture").boundingBox();
  await page.mouse.move(box.x + 100, box.y + 100);
  await page.mouse.down();
  await page.mouse.move(box.x + 160, box.y + 90, { steps: 5 });
  await page.mouse.up();
  await whole(page);
  assert.match(await page.textContent("#command"), /--turn -/);
  await equalsNative(page);
  const ends = await page.$$eval("#command span", parts => parts.map(part => [part.textContent, part.getClientRects().length]));
  assert.ok(ends.length > 3 && ends.every(([, lines]) => lines === 1), `an option and its value are on one line: ${ends}`);
  // The address contains the whole state.
  const again = await opened(page.url());
  assert.deepEqual(await shown(again), await shown(page));
  await again.close();
  await page.close();
}

async function pinned() {
  const page = await opened(`${server.address}#demo=corridor&size=160x120`);
  await page.click("#pin");
  await page.selectOption('[id="set-texel.method"]', { index: 1 });
  await whole(page);
  assert.match(await page.textContent("#numbers"), /[+\u2212]/);
  await page.click("#tab-changes");
  assert.match(await page.textContent("#panel"), /texel\.method/);
  await page.selectOption("#right", "pinned");
  assert.match(await page.textContent("#caption"), /the pinned run's image/);
  await page.close();
}

/** Tests that only a complete run can be pinned, and that the button says so. */
async function pinnedWhenComplete() {
  const page = await browser.chromium.newPage();
  await page.addInitScript(() => {
    globalThis.answers = [];
    const note = () => globalThis.answers.push([document.documentElement.dataset.settled, document.getElementById("pin").disabled]);
    new MutationObserver(note).observe(document, { subtree: true, attributeFilter: ["data-settled"] });
  });
  await page.goto(`${server.address}${QUICK.replace("160x120", "640x480")}`);
  await whole(page);
  const answers = await page.evaluate(() => globalThis.answers);
  assert.ok(answers.length > 2 && answers.every(([settled, isDisabled]) => isDisabled === (settled !== "true")), JSON.stringify(answers));
  assert.match(await page.getAttribute("#pin", "title"), /^Keep this run/);
  // A wrong first run gives no result at all.
  const failed = await browser.chromium.newPage();
  await failed.goto(`${server.address}${QUICK}&set=replacement.entries%3D0`);
  await failed.waitForSelector("#problem:visible");
  for (const id of ["#pin", "#copy", "#export"]) assert.ok(await failed.isDisabled(id), id);
  assert.equal(await failed.getAttribute("#pin", "title"), "You can pin a run once it is complete");
  await Promise.all([page.close(), failed.close()]);
}

/** Tests the cost of a pixel: pictures, and details under the pointer. */
async function costs() {
  const page = await opened(`${server.address}#demo=golf-ball&size=160x120`);
  await page.waitForFunction(() => document.documentElement.dataset.costs === document.documentElement.dataset.asked);
  const names = await page.locator("#left option").allTextContents();
  for (const name of ["cost", "wait", "overdraw", "level", "entry"]) assert.ok(names.includes(name), name);
  const box = await page.locator("#picture").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.waitForFunction(() => /cycles of units: .*fragment/.test(document.getElementById("caption").textContent));
  console.log(await page.textContent("#caption"));
  await page.selectOption("#left", "cost");
  await page.close();
}

async function wrong() {
  const page = await opened(`${server.address}${QUICK_SHADE}`);
  await page.fill("#search", "lanes of nothing");
  assert.match(await page.textContent("#controls"), /No parameter matches/);
  await page.fill("#search", "fifo.polygons.depth");
  await page.fill('[id="set-fifo.polygons.depth"]', "0");
  await page.keyboard.press("Tab");
  await page.waitForSelector("#problem:visible");
  assert.match(await page.textContent("#problem"), /fifo\.polygons\.depth.*expected/);
  // A rejected value has its way back at once.
  await page.click('[data-key="fifo.polygons.depth"].changed button');
  await whole(page);
  assert.ok(await page.isHidden('[data-key="fifo.polygons.depth"] button'));
  // A number of frames that is not whole changes nothing.
  await frames(page, "2.5");
  assert.doesNotMatch(page.url(), /frames/);
  await page.setInputFiles("#files", { name: "broken.glb", mimeType: "", buffer: Buffer.from("glTF and no more") });
  await page.waitForFunction(() => document.getElementById("problem").textContent.startsWith("broken.glb"));
  await page.close();
  // The first run of an address fails.
  const first = await browser.chromium.newPage();
  await first.goto(`${server.address}#set=replacement.lanes%3Dabc`);
  await first.waitForSelector("#problem:visible");
  assert.equal(await first.textContent("#answered"), "", "nothing is loading");
  await first.close();
}

/** Drops a model onto the page. */
async function dropped(model) {
  const page = await opened(`${server.address}${QUICK_SHADE}`);
  // A glTF file with all its neighbouring files except other models.
  const beside = model.endsWith(".gltf") ? readdirSync(dirname(model)).filter(name => !/\.(gltf|glb|obj)$/.test(name)) : [];
  await drop(page, model, ...beside.map(name => join(dirname(model), name)));
  await showsInput(page, basename(model));
  await browser.whole(page);
  await equalsNative(page, dirname(resolve(model)));
  await page.close();
}

/** Tests the warning about a property that the devices do not have: it stands beside the complete answer. */
async function warned() {
  const model = JSON.parse(readFileSync(new URL("../../tests/models/patch.gltf", import.meta.url)));
  for (const material of model.materials) material.occlusionTexture = { index: 0 };
  const page = await opened(`${server.address}${QUICK_SHADE}`);
  await page.setInputFiles("#files", { name: "warned.gltf", mimeType: "", buffer: Buffer.from(JSON.stringify(model)) });
  await showsInput(page, "warned.gltf");
  await browser.whole(page);
  assert.match(await page.textContent("#problem [data-kind=warning]"), /`occlusionTexture` is not used/);
  // An error and the warning are two lines.
  await page.setInputFiles("#files", { name: "broken.glb", mimeType: "", buffer: Buffer.from("glTF and no more") });
  await page.waitForSelector("#problem [data-kind=input]");
  assert.match(await page.innerText("#problem"), /^broken\.glb.*\n`occlusionTexture`/);
  await page.close();
}

/** Enters a number of frames; nothing is the default. */
async function frames(page, number) {
  await page.fill("input#frames", number);
  await page.keyboard.press("Enter");
}

/** Tests a stop during a quick answer: neither the complete answer follows nor the answer to a later change. */
async function stopped() {
  // A scene whose 64 small frames a fast machine does not finish before the click.
  const page = await opened(`${server.address}#demo=goblet&size=160x120`);
  const before = await page.textContent("#command");
  for (const changes of [["64"], ["63", "64"]]) {
    await page.selectOption("#size", "160x120");
    await page.selectOption("#size", "1920x1080");
    for (const number of changes) await frames(page, number);
    await page.waitForFunction(() => document.getElementById("answered").textContent === "computing\u2026");
    await page.click("#stop");
    assert.match(await page.textContent("#problem"), /^Stopped/);
    await page.waitForTimeout(2500);
    assert.ok(await page.isHidden("#stop"), "nothing is computed after a stop");
    assert.match(await page.textContent("#problem"), /^Stopped/);
    assert.equal(await page.textContent("#answered"), "The image, the command and the results are those of an earlier view.");
    await frames(page, "");
    await page.selectOption("#size", "160x120");
    await whole(page);
    assert.equal(await page.textContent("#command"), before);
  }
  await page.close();
}

/** Tests a stop without the server: the page starts no worker until the next change, says why that fails, and works again later. */
async function stoppedOffline() {
  const page = await opened(`${server.address}${QUICK_SHADE}`);
  let starts = 0;
  page.on("request", request => (starts += Number(request.url().endsWith("/worker.js"))));
  await page.context().setOffline(true);
  // So many frames that a fast machine does not finish before the click.
  await frames(page, "64");
  await page.selectOption("#size", "1920x1080");
  await page.click("#stop");
  await page.selectOption("#size", "320x240");
  await page.waitForFunction(() => document.getElementById("problem").textContent.startsWith("The simulator cannot start"));
  await page.waitForTimeout(500);
  assert.ok(starts <= 3, `${starts} starts`);
  await page.context().setOffline(false);
  await frames(page, "");
  await page.selectOption("#size", "160x120");
  await whole(page);
  faults.splice(0, Infinity, ...faults.filter(fault => !/ERR_INTERNET_DISCONNECTED/.test(fault)));
  await page.close();
}

async function standalone() {
  const page = await opened(`${pathToFileURL(resolve(folder, "standalone.html"))}#demo=goblet@1&size=160x120`);
  await equalsNative(page);
  await page.close();
}

try {
  for (const test of [wrong, warned, stopped, stoppedOffline, standalone, machines, slider, severalFrames, turned, pinned, pinnedWhenComplete, costs]) {
    await test();
    console.log(`ok: ${test.name}`);
  }
  for (const model of models) await dropped(model);
  assert.deepEqual(faults, []);
} finally {
  await browser.close();
  server.stop();
}
