// Tests the state of the page in Chromium: failed drops, history, undo, reload, links, and the layout at three widths.
//
//   node test/state.mjs PROGRAM PAGE_FOLDER MODEL
import assert from "node:assert/strict";
import { basename } from "node:path";
import { QUICK, command, drop, problem, settles, showsInput } from "./actions.mjs";
import { Browser } from "./chromium.mjs";
import { Native } from "./native.mjs";

const [program, folder, model] = process.argv.slice(2);
const native = new Native(program);
const server = await native.serve(folder);
const browser = await Browser.launch();
const opened = (hash, options) => browser.opened(`${server.address}${hash}`, options);

/** Files that cannot be opened, with the message. */
const BROKEN = [
  [["broken.glb", "glTF and no more"], /^broken\.glb/],
  [["notes.txt", "this is no model"], /notes\.txt/],
  [["alone.gltf", JSON.stringify({ asset: { version: "2.0" }, buffers: [{ uri: "gone.bin", byteLength: 4 }] })], /gone\.bin/],
];

async function failedDropKeepsTheOpenScene() {
  const page = await opened(QUICK);
  for (const [file, message] of BROKEN) {
    const before = { address: page.url(), command: await command(page), title: await page.title() };
    await drop(page, file);
    await page.waitForSelector("#problem:visible");
    assert.match(await problem(page), message);
    assert.deepEqual({ address: page.url(), command: await command(page), title: await page.title() }, before);
    assert.match(await page.textContent("#answered"), /^answered in/);
    await page.click("#dismiss");
    assert.equal(await page.isVisible("#problem"), false);
  }
  // The open scene still answers.
  await page.focus('[id="slide-replacement.lanes"]');
  await page.keyboard.press("Home");
  await settles(page, "--set replacement.lanes=1");
  // A good file replaces it.
  await drop(page, BROKEN[0][0]);
  await page.waitForSelector("#problem:visible");
  await drop(page, model);
  await showsInput(page, basename(model));
  await browser.whole(page);
  await page.close();
}

async function historyStepsThroughScenesAndParameters() {
  const page = await opened(QUICK);
  const slide = page.locator('[id="slide-replacement.lanes"]');
  await slide.focus();
  await page.keyboard.press("Home");
  await settles(page, "--set replacement.lanes=1");
  await page.selectOption("#demo", "ellipsoid");
  await showsInput(page, "ellipsoid");
  await browser.whole(page);
  assert.match(await page.title(), /ellipsoid/);
  await page.goBack();
  await showsInput(page, "cut-plane@1");
  await settles(page, "--set replacement.lanes=1");
  assert.equal(await slide.inputValue(), "0");
  await page.goBack();
  await settles(page, "--size 160x120");
  assert.notEqual(await slide.inputValue(), "0");
  await page.goForward();
  await settles(page, "--set replacement.lanes=1");
  await page.goForward();
  await showsInput(page, "ellipsoid");
  await browser.whole(page);
  await page.close();
}

async function dragIsOneStepOfUndo() {
  const page = await opened(QUICK);
  const length = () => page.evaluate(() => history.length);
  const before = await length();
  assert.ok(await page.isDisabled("#undo") && await page.isDisabled("#redo"));
  const box = await page.locator("#picture").boundingBox();
  await page.mouse.move(box.x + 100, box.y + 100);
  await page.mouse.down();
  await page.mouse.move(box.x + 160, box.y + 90, { steps: 8 });
  await page.mouse.up();
  await browser.whole(page);
  assert.match(await command(page), /--turn/);
  assert.equal(await length(), before + 1);
  await page.click("#undo");
  await settles(page, "--size 160x120");
  assert.ok(await page.isDisabled("#undo"));
  await page.keyboard.press("Control+Shift+Z");
  await page.waitForFunction(() => document.getElementById("command").textContent.includes("--turn"));
  assert.ok(await page.isDisabled("#redo"));
  await page.keyboard.press("Control+Z");
  await settles(page, "--size 160x120");
  await page.close();
}

async function lightIsRestoredAndReset() {
  const page = await opened(QUICK);
  await page.locator("#light").fill("90");
  await browser.whole(page);
  assert.match(await command(page), /--light 1,0\.9,0$/);
  const again = await opened(new URL(page.url()).hash);
  assert.equal(await again.locator("#light").inputValue(), "90");
  await again.click("#unlight");
  await settles(again, "--size 160x120");
  assert.equal(await again.locator("#light").inputValue(), "0");
  assert.equal(await again.isVisible("#unlight"), false);
  await again.close();
  await page.close();
}

async function reloadShowsTheDroppedFileAgain() {
  const page = await opened(QUICK);
  await drop(page, model);
  await showsInput(page, basename(model));
  await browser.whole(page);
  await page.reload();
  await showsInput(page, basename(model));
  await browser.whole(page);
  const { hash } = new URL(page.url());
  // Another browser lacks the file. Once dropped, it is shown as the address says.
  const context = await browser.chromium.newContext();
  const other = await context.newPage();
  await other.goto(`${server.address}${hash.replace("160x120", "320x240")}`);
  await other.waitForSelector("#problem:visible");
  assert.match(await problem(other), new RegExp(`Drop ${basename(model)}`));
  await other.waitForFunction(() => document.documentElement.dataset.settled === "true");
  await drop(other, model);
  await showsInput(other, basename(model));
  await other.waitForFunction(() => document.getElementById("command").textContent.includes("320x240"));
  await context.close();
  await page.close();
}

async function pinnedRunsSurviveInTheLink() {
  const page = await opened(QUICK);
  await page.click("#pin");
  await page.focus('[id="slide-fifo.fragments.depth"]');
  await page.keyboard.press("Home");
  await settles(page, "--set fifo.fragments.depth=1");
  const numbers = await page.textContent("#numbers");
  assert.match(numbers, /\+[\d,]+ \(/);
  const again = await opened(new URL(page.url()).hash);
  await again.waitForFunction(() => document.documentElement.dataset.pins === "1");
  assert.equal(await again.textContent("#numbers"), numbers);
  assert.match(await again.textContent("#pins"), /basrelief demo cut-plane@1 --machine bump --size 160x120/);
  await again.close();
  await page.close();
}

/** The picture and the figures stay in view while the page scrolls, and nothing is wider than the window. */
async function resultStaysInView() {
  for (const [width, height] of [[390, 844], [820, 1180], [1400, 900]]) {
    const page = await opened(QUICK.replace("160x120", "640x480"), { options: { viewport: { width, height } } });
    const isNarrow = width < 992;
    assert.equal(await page.evaluate(() => document.getElementById("inputs").open), !isNarrow, "parameters are collapsed on a phone");
    const top = await page.evaluate(() => document.getElementById("numbers").getBoundingClientRect().top);
    assert.ok(top < height / 2 + 50, `${width}: the figures begin at ${top}`);
    const [captions, offsets] = await page.evaluate(() => {
      const parts = name => [...document.querySelectorAll(`#numbers ${name}`)].map(part => part.getBoundingClientRect());
      const [boxes, values] = [parts("div"), parts("dd")];
      return [parts("dt").map(({ height }) => height), values.map(({ top }, at) => top - boxes[at].top)];
    });
    if (width === 390) assert.ok(Math.max(...captions) > 1.5 * Math.min(...captions), `no caption wraps: ${captions}`);
    assert.ok(offsets.every(offset => Math.abs(offset) < 1), `${width}: figures of a row are not aligned: ${offsets}`);
    await page.evaluate(() => (document.getElementById("inputs").open = true));
    for (const place of ["#controls", "#panel"]) {
      await page.evaluate(place => document.querySelector(place).scrollIntoView({ block: "end" }), place);
      await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
      for (const id of ["picture", "numbers"]) {
        const box = await page.locator(`#${id}`).boundingBox();
        assert.ok(box.y >= -1 && box.y + box.height <= height, `${width}, ${place}: ${id} is at ${box.y}, ${box.height} high`);
      }
    }
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${width}: nothing is wider`);
    await page.close();
  }
}

try {
  for (const test of [
    failedDropKeepsTheOpenScene, historyStepsThroughScenesAndParameters, dragIsOneStepOfUndo, lightIsRestoredAndReset,
    reloadShowsTheDroppedFileAgain, pinnedRunsSurviveInTheLink, resultStaysInView,
  ]) {
    await test();
    console.log(`ok: ${test.name}`);
  }
  assert.deepEqual(browser.faults, []);
} finally {
  await browser.close();
  server.stop();
}
