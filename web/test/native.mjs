// The program, as the page's tests use it.
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

/** What differs between equal runs: how fast the host was. */
export function comparable(report) {
  const { host: _, ...rest } = report;
  return rest;
}

/** The words of a command line as a shell splits them. */
export function words(line) {
  const found = line.match(/(?:'[^']*'|\\.|[^\s'\\])+/g) ?? [];
  return found.map(word => word.replace(/'([^']*)'|\\(.)/g, (_, quoted, plain) => quoted ?? plain));
}

export class Native {
  constructor(program) {
    this.program = resolve(program);
  }

  /** The report of a command line of `basrelief`. */
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

  /** Serves the page, or a model with its viewer: the address, and what ends it. */
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
