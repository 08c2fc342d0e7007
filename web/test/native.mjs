// The native program for the tests of the page.
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

/** Removes the speed of the host, the only difference between equal runs. */
export function comparable(report) {
  const { host: _, ...rest } = report;
  return rest;
}

/** Splits a command line into words as a shell does. */
export function words(line) {
  const found = line.match(/(?:'[^']*'|\\.|[^\s'\\])+/g) ?? [];
  return found.map(word => word.replace(/'([^']*)'|\\(.)/g, (_, quoted, plain) => quoted ?? plain));
}

export class Native {
  constructor(program) {
    this.program = resolve(program);
  }

  /** Returns the report of a `basrelief` command line. */
  report(line, folder = process.cwd()) {
    const [, ...args] = words(line);
    const out = mkdtempSync(join(tmpdir(), "basrelief-page-"));
    try {
      execFileSync(this.program, [...args, "--quiet", "--out", out], { cwd: folder, stdio: ["ignore", "ignore", "pipe"] });
      return comparable(JSON.parse(readFileSync(join(out, "report.json"), "utf8")));
    } finally {
      rmSync(out, { recursive: true });
    }
  }

  /** Serves the page, or a model with its viewer. Returns the address and a function that stops the server. */
  async serve(folder, model) {
    const what = model === undefined ? ["page"] : ["serve", model];
    const server = spawn(this.program, [...what, "--listen", "127.0.0.1:0", "--folder", folder], { stdio: ["ignore", "pipe", "inherit"] });
    const said = await new Promise((done, failed) => {
      server.stdout.once("data", bytes => done(String(bytes)));
      server.once("exit", code => failed(new Error(`basrelief ${what[0]} ended with ${code}`)));
    });
    const ended = new Promise(done => server.once("exit", done));
    return { address: said.match(/http:\S+/)[0], stop: () => (server.kill(), ended) };
  }
}
