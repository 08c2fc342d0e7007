// Builds the page: node build.mjs SIMULATOR.wasm FOLDER. Three forms of it: files to be served, the same for a server of scenes, and
// standalone.html, one file that works from a disk. Neither asks anybody else for anything, which its policy holds it to.
import { createHash } from "node:crypto";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { brotliCompressSync, constants, gzipSync } from "node:zlib";
import { build } from "esbuild";

/** Largest size of the page [bytes, brotli]: 1,367,739 measured with steps in the timeline and drafts over a slow path. */
const BUDGET = 1_400_000;

const here = dirname(fileURLToPath(import.meta.url));
const [wasmPath, folder] = process.argv.slice(2);
if (!wasmPath || !folder) {
  console.error("usage: node build.mjs SIMULATOR.wasm FOLDER");
  process.exit(2);
}

async function script(entry, define = {}) {
  const options = { bundle: true, minify: true, write: false, format: "iife", target: "es2022", legalComments: "none", define };
  const { outputFiles } = await build({ ...options, entryPoints: [join(here, "src", entry)] });
  return outputFiles[0].text;
}

const html = await readFile(join(here, "index.html"), "utf8");
const [ofReports, own] = await Promise.all([
  readFile(join(here, "../crates/report/src/html/style.css"), "utf8"), readFile(join(here, "style.css"), "utf8"),
]);
// The last rule holds the style of the page itself, which a saved report leaves out (src/saved.ts).
const style = `${ofReports}\n@media all {\n${own}}\n`;
const wasm = await readFile(wasmPath);
const known = {
  SIMULATOR_BYTES: String(wasm.length),
  SIMULATOR_NAME: JSON.stringify(createHash("sha256").update(wasm).digest("hex").slice(0, 16)),
};
const [served, worker] = await Promise.all([script("served.ts", known), script("worker.ts", known)]);

/** Puts pieces in their places. (By a function: `$` in a piece means nothing.) */
function page(policy, styles, scripts) {
  const meta = `<meta http-equiv="Content-Security-Policy" content="${policy}">`;
  return html.replace("<!--policy-->", () => meta).replace("<!--style-->", () => styles).replace("<!--script-->", () => scripts);
}

const common = "default-src 'none'; base-uri 'none'; form-action 'none'; img-src 'self' blob: data:";
const strict = `${common}; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; style-src 'self'; connect-src 'self'`;
const link = '<link rel="stylesheet" href="page.css"><link rel="icon" href="data:,">';
const index = page(strict, link, '<script src="page.js" defer></script>');

// The same, for a server of scenes: it draws what is offered there.
const viewer = index.replace("<html ", "<html data-from ");

const packed = gzipSync(wasm, { level: 9 }).toString("base64");
const alone = (await script("standalone.ts", { ...known, WORKER: JSON.stringify(worker), SIMULATOR: JSON.stringify(packed) }))
  .replaceAll("</script", "<\\/script");
const hash = text => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
const closed = `${common}; script-src ${hash(alone)} 'wasm-unsafe-eval'; worker-src blob:; style-src ${hash(style)}`;
const standalone = page(closed, `<style>${style}</style><link rel="icon" href="data:,">`, `<script>${alone}</script>`);

await mkdir(folder, { recursive: true });
const files = {
  "index.html": index, "viewer.html": viewer, "page.css": style, "page.js": served, "worker.js": worker, "basrelief.wasm": wasm,
};
// Beside each file that is served lie its compressed forms: browsers take gzip from anywhere, brotli from this computer or over TLS.
const quality = {
  params: {
    [constants.BROTLI_PARAM_QUALITY]: 11, [constants.BROTLI_PARAM_LGWIN]: 24, [constants.BROTLI_PARAM_LGBLOCK]: 16,
    [constants.BROTLI_PARAM_NPOSTFIX]: 1, [constants.BROTLI_PARAM_NDIRECT]: 8,
  },
};
const brotli = Object.fromEntries(Object.entries(files).map(([name, file]) => [`${name}.br`, brotliCompressSync(file, quality)]));
const gzip = Object.fromEntries(Object.entries(files).map(([name, file]) => [`${name}.gz`, gzipSync(file, { level: 9 })]));
const written = { ...files, ...brotli, ...gzip, "standalone.html": standalone };
await Promise.all(Object.entries(written).map(([name, content]) => writeFile(join(folder, name), content)));

const loaded = Object.entries(brotli).reduce((sum, [name, file]) => sum + (name === "viewer.html.br" ? 0 : file.length), 0);
console.log(`the page is ${loaded} bytes in brotli, allowed ${BUDGET}; standalone.html is ${standalone.length} bytes`);
if (loaded > BUDGET) {
  console.error("the page is too large");
  process.exit(1);
}
