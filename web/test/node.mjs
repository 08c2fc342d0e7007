// Compares the simulator as WebAssembly with the native program on every demo. The reports are equal to the byte, except for the
// host's speed.
//
//   node test/node.mjs PROGRAM PAGE_FOLDER
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { build } from "esbuild";
import { comparable, Native } from "./native.mjs";

const [program, folder] = process.argv.slice(2);
const native = new Native(program);
// Loads the simulator as the page does, without the page.
const { outputFiles } = await build({
  entryPoints: [join(import.meta.dirname, "../src/wasm.ts")], bundle: true, write: false, format: "esm", platform: "node",
});
const { simulator } = await import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString("base64")}`);
const ask = await simulator(await WebAssembly.compile(readFileSync(pathToFileURL(join(folder, "basrelief.wasm")))));

const told = question => {
  const { json, rest } = ask(question);
  assert.equal(json.error, undefined);
  if (question.ask !== "run") return json;
  const [place, length] = json.report;
  return { ...json, report: JSON.parse(new TextDecoder().decode(rest.subarray(place, place + length))) };
};
const { demos } = told({ ask: "catalogue" });
for (const { name } of demos) {
  const { machine } = told({ ask: "demo", name });
  const view = { size: [160, 120], turn: [12.5, -3] };
  const { report, command } = told({ ask: "run", machine, set: [], view, exact: true, limits: true });
  assert.deepEqual(comparable(report), native.report(command), command);
  console.log(`equal: ${command}: ${report.cycles.total} cycles, picture ${report.image.at(-1).sha256.slice(0, 12)}`);
}
