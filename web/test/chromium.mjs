// Chromium for the tests of the page.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { chromium } from "playwright-core";
import { comparable } from "./native.mjs";

const QUIET = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

export class Browser {
  /** Faults: errors, warnings, and requests to other hosts. */
  faults = [];

  static async launch() {
    const browser = new Browser();
    browser.chromium = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: QUIET });
    return browser;
  }

  close() {
    return this.chromium.close();
  }

  async opened(address, { options = {}, counting } = {}) {
    const page = await this.chromium.newPage({ viewport: { width: 1400, height: 900 }, ...options });
    page.setDefaultTimeout(120_000);
    page.on("console", message => message.type() !== "log" && this.faults.push(`${message.type()}: ${message.text()}`));
    page.on("pageerror", error => this.faults.push(String(error)));
    page.on("request", request => {
      const { protocol, hostname } = new URL(request.url());
      const inside = ["blob:", "data:", "file:"].includes(protocol) || hostname === "127.0.0.1";
      if (!inside) this.faults.push(`asks for ${request.url()}`);
    });
    page.counted = counting?.(page);
    await page.goto(address);
    await this.whole(page);
    return page;
  }

  /** Waits for the complete answer to the last change. Warnings of an input may stand above it. */
  async whole(page) {
    await page.waitForTimeout(50);
    await page.waitForFunction(() => document.documentElement.dataset.settled === "true");
    const problems = await page.locator("#problem [data-kind=input], #problem [data-kind=run]").allTextContents();
    assert.deepEqual(problems, []);
  }

  /** Returns the saved report, and the command that repeats it. */
  async shown(page) {
    const [download] = await Promise.all([page.waitForEvent("download"), page.click("#save")]);
    return { report: comparable(JSON.parse(readFileSync(await download.path(), "utf8"))), command: await page.textContent("#command") };
  }
}
