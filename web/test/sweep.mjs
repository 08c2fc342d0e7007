// Tests the page of a sweep in Chromium, opened from disk, with user actions.
//
//   node web/test/sweep.mjs PAGE.html
import assert from "node:assert/strict";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [file] = process.argv.slice(2);
const address = pathToFileURL(file).href;
const quiet = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: quiet });
const faults = [];

async function opened(options) {
  const page = await browser.newPage({ viewport: { width: 1400, height: 900 }, ...options });
  page.on("console", message => faults.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", error => faults.push(String(error)));
  page.on("request", request => new URL(request.url()).protocol === "file:" || faults.push(`asks for ${request.url()}`));
  await page.goto(address);
  return page;
}

const told = page => page.textContent("#point");
const name = page => page.textContent("#point code");
const places = page => page.$$eval("#points .point:not(.off)", all => all.map(dot => [dot.getAttribute("cx"), dot.getAttribute("cy")].join()));

// The page first shows a Pareto-optimal point with its picture.
const page = await opened();
assert.match(await told(page), /^Point \d+, Pareto-optimal/);
assert.ok(await page.$eval("#point img", image => image.decode().then(() => image.naturalWidth > 0)));

// Keys move from the first to the last point, and along the Pareto front alone.
await page.focus("#plot");
const rows = await page.$$eval("#points .point", all => all.length);
const seen = new Set();
await page.keyboard.press("Home");
for (let step = 0; step < rows; step++) {
  seen.add(await name(page));
  await page.keyboard.press("ArrowRight");
}
assert.equal(seen.size, rows, "arrow keys reach every point");
await page.keyboard.press("ArrowUp");
assert.match(await told(page), /^Point \d+, Pareto-optimal/);

// The pointer selects the point below it. A click keeps the selection.
await page.keyboard.press("Escape");
const dot = page.locator("#points .point").first();
await dot.hover({ force: true });
// The pointer event arrives with the next frame.
await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
const hovered = await name(page);
await dot.click({ force: true });
await page.mouse.move(5, 5);
assert.equal(await name(page), hovered);

// Other figures move the points and show their axes and colours. The first figures restore the first picture.
const before = await places(page);
await page.selectOption("#across", { index: 3 });
await page.selectOption("#colour", { index: 2 });
assert.notDeepEqual(await places(page), before);
assert.deepEqual(await page.$$eval("#plot g[id^=x-]:not(.off)", all => all.map(group => group.id)), ["x-3"]);
assert.ok(await page.isVisible("#colours-1") && !await page.isVisible("#colours-0"));
assert.ok(await page.locator("#points [class*=level-]").count() > 0);
await page.selectOption("#across", { index: 0 });
await page.selectOption("#colour", { index: 0 });
// The page writes two decimals, the script all decimals.
const numbers = all => all.flatMap(place => place.split(",").map(Number));
assert.ok(numbers(await places(page)).every((x, at) => Math.abs(x - numbers(before)[at]) < 0.01));

// A button in the table selects its point. The point has the number of its row, and its row is marked.
const button = page.locator("#chosen button").first();
await button.focus();
assert.equal(await name(page), await button.getAttribute("data-id"));
assert.match(await told(page), /^Point 1, Pareto-optimal/);
assert.deepEqual(await page.locator("tr.current button").allTextContents(), ["1"]);

// Without scripts, on a phone, in dark mode.
const plain = await opened({ javaScriptEnabled: false });
assert.ok(await plain.isVisible(".plot") && !await plain.isVisible("#choose"));
const phone = await opened({ viewport: { width: 400, height: 800 }, colorScheme: "dark" });
assert.ok(await phone.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "nothing is wider than a phone");

await browser.close();
assert.deepEqual(faults, []);
console.log(`sweep page: ${rows} points, keys, pointer, choices, pictures; nothing asked for but files beside it`);
