// Renews the screenshots of the documents: the block diagram of a report, the scatter chart of a sweep, and the simulator page.
//
//   node web/pictures.mjs PROGRAM PAGE_FOLDER OUT
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { settles } from "./test/actions.mjs";
import { Browser } from "./test/chromium.mjs";
import { Native } from "./test/native.mjs";

const [program, folder, out] = process.argv.slice(2);
const MARGIN = 20;
const native = new Native(program);
const browser = await Browser.launch();
const scratch = mkdtempSync(join(tmpdir(), "basrelief-pictures-"));
const run = (...args) => execFileSync(resolve(program), [...args, "--quiet"], { stdio: "inherit" });

/** Takes a picture of one section of a page on disk. */
async function section(file, name, picture) {
  const page = await browser.chromium.newPage({ viewport: { width: 1180, height: 900 } });
  await page.goto(pathToFileURL(file).href);
  const { x, y, width, height } = await page.locator(`section[aria-labelledby=${name}]`).boundingBox();
  const clip = { x: x - MARGIN, y: y + 1, width: width + 2 * MARGIN, height: height + MARGIN };
  await page.screenshot({ path: join(out, picture), clip, fullPage: true });
  await page.close();
}

/** Takes a picture of the simulator page that compares two runs. */
async function simulator() {
  const server = await native.serve(folder);
  const page = await browser.opened(`${server.address}#demo=corridor&size=320x240`, {
    options: { viewport: { width: 1400, height: 900 } },
  });
  await page.click("#pin");
  await page.selectOption('[id="set-memory.texture.part"]', "sdr-100");
  await settles(page, "memory.texture.part=sdr-100");
  await page.click("#pin");
  await page.click("#compare");
  await page.waitForSelector("#explained td.right");
  await page.evaluate(() => scrollTo(0, 0));
  await page.screenshot({ path: join(out, "simulator.png") });
  await server.stop();
}

try {
  const report = join(scratch, "ball.html");
  run("demo", "golf-ball", "--html", report);
  await section(report, "diagram-title", "page.png");
  const lanes = join(scratch, "lanes");
  run("sweep", "studies/search-lanes.toml", "--out", lanes);
  await section(join(lanes, "sweep.html"), "scatter-title", "sweep.png");
  await simulator();
} finally {
  await browser.close();
  rmSync(scratch, { recursive: true });
}
