// Tests the viewer in Chromium with a real server. The test turns the view, counts the bytes received by the browser, and
// compares each view with the native program on the same server.
//
//   node web/test/viewer.mjs PROGRAM PAGE_FOLDER [FOLDER_FOR_PICTURES]
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { get } from "node:http";
import { join } from "node:path";
import { brotliDecompressSync, gunzipSync, gzipSync } from "node:zlib";
import { tilesOf } from "./actions.mjs";
import { Native } from "./native.mjs";
import { Browser } from "./chromium.mjs";

const [program, folder, shots] = process.argv.slice(2);
const native = new Native(program);
const server = await native.serve(folder, "demo:gallery");
const browser = await Browser.launch();

/** Maximum compressed size of the page itself \[bytes\], as in build.mjs. */
const BUDGET = 1_490_000;

/** Counts tiles requested from the network and the bytes of their answers, without the page itself. Cached tiles are not
 *  requested. */
function counted(page) {
  const come = { tiles: [], requests: 0, bytes: 0, page: 0 };
  page.on("response", async response => {
    const [, path] = response.url().split("/tile/");
    if (path === undefined) {
      if (/\/(\w+\.(css|js|wasm))?$/.test(new URL(response.url()).pathname)) come.page += Number(response.headers()["content-length"]);
      return;
    }
    const tiles = tilesOf(path);
    come.requests += 1;
    come.tiles.push(...tiles);
    come.bytes += Number(response.headers()["content-length"]) - (tiles.length > 1 ? 4 * tiles.length : 0);
  });
  return come;
}

const numbers = text => (text.match(/\d[\d,]*/g) ?? []).map(number => Number(number.replaceAll(",", "")));

/** Compares the view with the native program, which renders once from the same server and once from the model itself. */
async function equalsNative(page, model) {
  const { report, command } = await browser.shown(page);
  assert.match(command, /^basrelief run --from http:\/\/127\.0\.0\.1:\d+\/ /);
  assert.deepEqual(report, native.report(command), command);
  const here = native.report(`${command.replace(/run --from \S+/, `demo ${model}`)} --no-exact`);
  assert.equal(report.cycles.total, here.cycles.total);
  assert.deepEqual(report.image, here.image);
  console.log(`equal: ${command}: ${report.cycles.total} cycles, picture ${report.image.at(-1).sha256.slice(0, 12)}`);
  return report;
}

async function looksAround() {
  const page = await browser.opened(`${server.address}#size=320x240&set=defer.mode%3Dprogressive`, { counting: counted });
  const first = await equalsNative(page, "gallery");
  const all = first.figures.conventional_tile_bytes;
  const come = page.counted;
  assert.ok(come.page > 0 && come.page <= BUDGET, `the page takes ${come.page} bytes`);
  console.log(`the page takes ${come.page} bytes`);
  assert.ok(come.tiles.length >= first.figures.path_tiles, "what the picture is made of has come");
  assert.equal(new Set(come.tiles).size, come.tiles.length, "no tile comes twice");
  assert.ok(come.requests < come.tiles.length, "several tiles come with one request");
  assert.ok(Number(await page.evaluate(() => document.documentElement.dataset.sketches)) >= 1, "pictures are shown as they come");
  const told = async () => [numbers(await page.textContent("#path-all")), numbers(await page.textContent("#path-view"))];
  assert.deepEqual((await told())[0].slice(0, 2), [come.bytes, all], "the bar holds what has come against all tiles");
  assert.equal((await told())[1][0], come.bytes, "all that has come is for the first view");
  // A turned view fetches only missing tiles.
  const before = { ...come };
  await page.focus("#picture");
  await page.keyboard.press("ArrowRight");
  await browser.whole(page);
  const second = await equalsNative(page, "gallery");
  assert.ok(come.bytes > before.bytes, "another view needs other tiles");
  assert.ok(come.bytes - before.bytes < second.figures.path_tile_bytes, "and not all of its tiles anew");
  assert.equal((await told())[1][0], come.bytes - before.bytes, "the bytes of the last view are told");
  assert.equal(new Set(come.tiles).size, come.tiles.length, "no tile comes twice");
  // The first view fetches nothing again.
  const kept = come.requests;
  await page.focus("#picture");
  await page.keyboard.press("ArrowLeft");
  await browser.whole(page);
  assert.equal(come.requests, kept, "what came before is kept");
  assert.match(await page.textContent("#path-view"), /^This view: 0 bytes, in 0 tiles; all tiles were already here/);
  console.log(await page.textContent("#path-all"));
  await page.close();
}

/** Tests the byte counts while tiles arrive. A view is answered first in small and then in full size, and the bytes of both are
 *  counted. A restarted simulator starts at zero. */
async function counts() {
  const page = await browser.opened(`${server.address}#size=320x240&set=defer.mode%3Dprogressive`);
  await page.evaluate(() => {
    const [view, share] = ["path-view", "path-share"].map(id => document.getElementById(id));
    globalThis.told = [];
    const tell = () => globalThis.told.push([view.textContent, parseFloat(share.style.width)]);
    new MutationObserver(tell).observe(view, { childList: true });
    location.hash = "#size=640x480&turn=40,0&set=defer.mode%3Dprogressive";
  });
  await page.waitForFunction(() => document.getElementById("what").textContent.includes("640"));
  await browser.whole(page);
  const told = await page.evaluate(() => globalThis.told);
  const coming = told.filter(([text]) => text.includes("received so far")).map(([, share]) => share);
  assert.ok(new Set(coming).size > 2, "what comes is told while it comes, and the bar grows not with answers alone");
  const [bytes, shares] = [told.map(([text]) => numbers(text)[0]), told.map(([, share]) => share)];
  // A request for several tiles also transfers their lengths, but an answer counts tiles alone.
  const lengths = 4 * 64;
  bytes.forEach((now, i) => assert.ok(i === 0 || now + lengths >= bytes[i - 1], `the view's bytes fall: ${bytes.slice(i - 1, i + 1)}`));
  shares.forEach((now, i) => assert.ok(i === 0 || now >= shares[i - 1], `the bar falls: ${shares.slice(i - 1, i + 1)}`));
  const [come, all] = numbers(await page.textContent("#path-all"));
  assert.ok(Math.abs(shares.at(-1) - (100 * come) / all) < 0.06, `the bar is as long as it says: ${shares.at(-1)} %`);
  assert.equal(bytes.at(-1), come, "all that has come is for this view");
  assert.match(await page.textContent("#answered"), /^answered in \d+ ms, \d+ of them computing/);
  await page.close();
}

/** Tests the forms of the simulator: brotli for a browser that accepts it, otherwise gzip at its best level, otherwise as it is. */
async function compressed() {
  const simulator = readFileSync(join(folder, "basrelief.wasm"));
  const sizes = [];
  for (const [accepts, encoding, unpack] of [
    ["gzip, deflate, br, zstd", "br", brotliDecompressSync], ["gzip, deflate, br;q=0", "gzip", gunzipSync], ["identity", undefined, body => body],
  ]) {
    const { headers, body } = await new Promise((done, failed) => get(`${server.address}basrelief.wasm`, { headers: { "accept-encoding": accepts } }, answer => {
      const parts = [];
      answer.on("data", part => parts.push(part)).on("end", () => done({ headers: answer.headers, body: Buffer.concat(parts) }));
    }).on("error", failed));
    assert.equal(headers["content-encoding"], encoding);
    assert.match(headers.vary, /accept-encoding/i);
    assert.ok(unpack(body).equals(simulator), `${encoding}: it is the simulator`);
    sizes.push(body.length);
  }
  const [brotli, gzip, plain] = sizes;
  console.log(`the simulator takes ${brotli} bytes in brotli, ${gzip} in gzip, ${plain} as it is`);
  assert.ok(gzip <= gzipSync(simulator, { level: 9 }).length && brotli < 0.85 * gzip, "each has its best level");
}

/** Tests another encoding, whose size only the server knows, and the message after a server failure. */
async function otherwise() {
  const page = await browser.opened(`${server.address}#size=160x120&set=tile.encoding%3Dpng`);
  const report = await equalsNative(page, "gallery");
  assert.equal(numbers(await page.textContent("#path-all"))[1], report.figures.conventional_tile_bytes);
  await server.stop();
  await page.focus("#picture");
  await page.keyboard.press("ArrowUp");
  await page.waitForSelector("#problem:visible");
  assert.match(await page.textContent("#problem"), /texture \d+ .*layer \d+, tile \d+: http:.*no connection to the server.*attempt 3/);
  const caption = await page.textContent("#caption");
  assert.ok(!/still loading|better ones follow/.test(caption), `the caption promises no further tiles: ${caption}`);
  assert.ok(!/so far/.test(await page.textContent("#path-view")), "no bytes are coming");
  const answered = await page.textContent("#answered");
  assert.match(answered, /^The (image, the )?command and the results are those of an earlier view\.$/);
  assert.equal(/not complete/.test(caption), !answered.includes("image"), "a draft is called a draft");
  await page.close();
}

/** Takes pictures in light, dark and narrow form. */
async function pictures() {
  for (const [name, options] of Object.entries({
    light: {}, dark: { colorScheme: "dark" }, narrow: { viewport: { width: 420, height: 900 } },
  })) {
    const page = await browser.opened(server.address, { options });
    assert.equal(await page.isVisible("#open"), false, "there is nothing to be opened in a viewer");
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${name}: nothing is wider than the window`);
    if (shots) await page.screenshot({ path: join(shots, `viewer-${name}.png`), fullPage: true });
    await page.close();
  }
}

try {
  for (const test of [compressed, looksAround, counts, ...(shots ? [pictures] : []), otherwise]) {
    await test();
    console.log(`ok: ${test.name}`);
  }
  assert.deepEqual(browser.faults.filter(fault => !/ERR_CONNECTION_REFUSED/.test(fault)), []);
} finally {
  await browser.close();
  server.stop();
}
