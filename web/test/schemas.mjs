// Tests the printed JSON schemas: Ajv compiles each of them in its strict mode, a report fits its schema, and a language server for TOML
// checks plans by theirs.
//
//   node web/test/schemas.mjs PROGRAM FOLDER
//
// FOLDER receives the files of a run.
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import Ajv2020 from "ajv/dist/2020.js";

const [program, folder] = process.argv.slice(2);
const printed = (...line) => JSON.parse(execFileSync(program, line, { encoding: "utf8", maxBuffer: 1 << 26 }));
const names = ["bump", "shade", "texel", "defer"];
const ofMachines = ["config", "plan"].flatMap(of => names.map(machine => [of, "--machine", machine]));
const compiled = [["trace"], ["report"], ["camera"], ["views"], ...ofMachines].map(of => new Ajv2020().compile(printed("schema", ...of)));
const report = printed("demo", "golf-ball", "--size", "32x24", "--json", "--out", folder);
assert.ok(compiled[1](report), JSON.stringify(compiled[1].errors));
// Proves that the schema can refuse a report.
assert.ok(!compiled[1]({ ...report, size: { width: -1, height: 24 } }));
assert.ok(!compiled[1]({ ...report, size: { width: 2 ** 32, height: 24 } }));
console.log(`${compiled.length} schemas compiled in strict mode`);

/** Returns the exit code and the messages of Taplo for plans of a machine. */
function linted(machine, plans) {
  const schema = pathToFileURL(join(resolve(folder), `plan-${machine}.json`)).href;
  const taplo = fileURLToPath(new URL("../node_modules/.bin/taplo", import.meta.url));
  const { status, stderr } = spawnSync(taplo, ["lint", "--schema", schema, ...plans], { encoding: "utf8" });
  return { status, stderr };
}

mkdirSync(folder, { recursive: true });
for (const machine of names) writeFileSync(join(folder, `plan-${machine}.json`), JSON.stringify(printed("schema", "plan", "--machine", machine)));
const studies = fileURLToPath(new URL("../../studies/", import.meta.url));
const plans = readdirSync(studies).filter(name => name.endsWith(".toml")).map(name => join(studies, name));
const machineOf = plan => /^machine = "(\w+)"/m.exec(readFileSync(plan, "utf8"))?.[1] ?? "bump";
// Taplo takes seconds to start, so it checks all plans of a machine at once.
for (const machine of names) {
  const { status, stderr } = linted(machine, plans.filter(plan => machineOf(plan) === machine));
  assert.equal(status, 0, `${machine}: ${stderr}`);
}
const wrong = join(folder, "wrong.toml");
writeFileSync(wrong, 'input = "demo:golf-ball"\nobjectives = ["cycles min"]\n[axes]\nreplacement.lanes = [0]\n');
const { status, stderr } = linted("bump", [wrong]);
assert.equal(status, 1);
assert.match(stderr, /0 is .*minimum|not valid under any of the/);
console.log(`Taplo accepts ${plans.length} plans and refuses a wrong one`);
