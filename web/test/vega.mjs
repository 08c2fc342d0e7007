// Tests the chart of a sweep for Vega-Lite. It validates against the schema of Vega-Lite, compiles and draws without a warning,
// and has a mark for each point.
//
//   node web/test/vega.mjs SWEEP.vl.json
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import Ajv from "ajv";
import addFormats from "ajv-formats";
import * as vega from "vega";
import * as vegaLite from "vega-lite";

const chart = JSON.parse(readFileSync(process.argv[2], "utf8"));
const schema = createRequire(import.meta.url)("vega-lite/vega-lite-schema.json");
assert.equal(chart.$schema, `https://vega.github.io/schema/vega-lite/v${vegaLite.version.split(".")[0]}.json`);

const ajv = addFormats(new Ajv({ strict: false })).addFormat("color-hex", () => true);
const fits = ajv.validate(schema, chart);
assert.ok(fits, JSON.stringify(ajv.errors, null, 2));
// Proves that the schema can refuse a chart.
assert.ok(!ajv.validate(schema, { ...chart, layer: [{ mark: "spot" }] }));

const faults = [];
const logger = vega.logger(vega.Warn, undefined, (_, level, text) => faults.push(`${level}: ${text}`));
const compiled = vegaLite.compile(chart, { logger }).spec;
const view = new vega.View(vega.parse(compiled), { renderer: "none", logger });
const svg = await view.toSVG();
assert.deepEqual(faults, []);
const marks = svg.split('aria-roledescription="point"').length - 1;
assert.equal(marks, chart.data.values.length);
assert.match(svg, /aria-roledescription="line mark"/);
console.log(`${chart.title}: keeps to the schema of Vega-Lite ${vegaLite.version}; ${marks} points drawn`);
