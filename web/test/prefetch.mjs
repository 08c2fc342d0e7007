// Tests the order of events between requests for tiles and the questions for drafts, which a browser leaves to chance.
//
//   node web/test/prefetch.mjs
import assert from "node:assert/strict";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const entryPoints = [fileURLToPath(new URL("../src/prefetch.ts", import.meta.url))];
const { outputFiles } = await build({ bundle: true, write: false, format: "esm", target: "es2022", entryPoints });
const { Prefetch } = await import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString("base64")}`);

/** Requests in their order, each with the function that answers it. */
let requests = [];
globalThis.fetch = (address, { signal }) => new Promise((done, failed) => {
  requests.push({ address, answer: () => done(new Response("a tile")) });
  signal.addEventListener("abort", () => failed(signal.reason));
});

/** Waits until all that has been answered is delivered. */
const settled = () => new Promise(done => setTimeout(done, 5));
const asked = () => requests.map(({ address }) => address);

function prefetch() {
  requests = [];
  return new Prefetch({ received: async () => undefined, came: () => undefined });
}

const listed = ["hashes/a/0", "tile/a/1,2", "tile/a/3,4", "tile/a/5,6", "tile/a/7,8", "tile/a/9"];

async function requestsThatEndDuringAQuestionStayAlone() {
  const fetched = prefetch();
  fetched.want({ missing: listed, needed: [] }, true);
  assert.deepEqual(asked(), listed.slice(0, 4), "four at a time");
  const pending = fetched.pending();
  assert.deepEqual(pending, listed, "a question names those under way and those in the queue");
  // While the draft is drawn, two requests end, and two begin: one of them ends as well.
  for (const ended of [0, 1, 4]) {
    requests[ended].answer();
    await settled();
  }
  assert.deepEqual(asked(), listed);
  fetched.want({ missing: ["tile/b/1"], needed: pending }, true);
  requests.forEach(({ answer }) => answer());
  await settled();
  assert.deepEqual(asked(), [...listed, "tile/b/1"], "nothing is requested twice");
  assert.equal(fetched.left, 1);
}

async function anotherViewReplacesTheQueue() {
  const fetched = prefetch();
  fetched.want({ missing: listed, needed: [] }, false);
  fetched.want({ missing: ["tile/b/1"], needed: [listed[5], listed[0]] }, true);
  assert.deepEqual(fetched.pending(), [...listed.slice(0, 4), listed[5], "tile/b/1"]);
  await settled();
  assert.deepEqual(fetched.pending(), [listed[0], listed[5], "tile/b/1"], "those that the view does not need are cancelled");
  fetched.stop();
  await settled();
  assert.equal(fetched.left, 0);
}

for (const test of [requestsThatEndDuringAQuestionStayAlone, anotherViewReplacesTheQueue]) {
  await test();
  console.log(`ok: ${test.name}`);
}
