// Tests the printed JSON schemas: Ajv compiles each of them in its strict mode, and a report fits its schema.
//
//   node web/test/schemas.mjs PROGRAM FOLDER
//
// FOLDER receives the files of a run.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import Ajv2020 from "ajv/dist/2020.js";

const program = process.argv[2];
const printed = (...line) => JSON.parse(execFileSync(program, line, { encoding: "utf8", maxBuffer: 1 << 26 }));
const machines = ["bump", "shade", "texel", "defer"].map((machine) => ["config", "--machine", machine]);
const compiled = [["trace"], ["report"], ["camera"], ...machines].map((of) => new Ajv2020().compile(printed("schema", ...of)));
const report = printed("demo", "golf-ball", "--size", "32x24", "--json", "--out", process.argv[3]);
assert.ok(compiled[1](report), JSON.stringify(compiled[1].errors));
// Proves that the schema can refuse a report.
assert.ok(!compiled[1]({ ...report, size: { width: -1, height: 24 } }));
assert.ok(!compiled[1]({ ...report, size: { width: 2 ** 32, height: 24 } }));
console.log(`${compiled.length} schemas compiled in strict mode`);
