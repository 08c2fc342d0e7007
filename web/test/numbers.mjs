// Tests that the page writes numbers as the reports do (crates/report/src/number.rs).
//
//   node web/test/numbers.mjs
import assert from "node:assert/strict";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const entryPoints = [fileURLToPath(new URL("../src/dom.ts", import.meta.url))];
const { outputFiles } = await build({ bundle: true, write: false, format: "esm", target: "es2022", entryPoints });
const { decimal } = await import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString("base64")}`);

const written = [5, 0.67, 0.1, 0.05, 0.001_234_6, 0.099_99, 2e-6, 3.456e-9, 0].map(x => decimal(x, 2));
assert.deepEqual(written, ["5.00", "0.67", "0.10", "0.0500", "0.00123", "0.100", "0.00000200", "3.46e-9", "0.00"]);
const large = [999.994, 999.996, 16_470.034, -16_470.5, 1e15].map(x => decimal(x, 2));
assert.deepEqual(large, ["999.99", "1,000", "16,470", "-16,470", "1,000,000,000,000,000"]);
console.log("ok: numbers have separators or significant digits");
