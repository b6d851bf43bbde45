// Builds what pages contain (`.ci/task viewer`): node build.mjs SOURCE NODE_MODULES

import { build } from "esbuild";
import { createHash } from "node:crypto";
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";

const [, , here, modules] = process.argv;
const out = join(here, "..", "built");
mkdirSync(out, { recursive: true });
const usual = {
  nodePaths: [modules],
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  charset: "utf8",
  legalComments: "inline",
};
// What it is built from, so that a test without Node.js can tell whether it was built again after a change.
const sources = readdirSync(here).filter((name) => /\.(m?js|json)$/.test(name)).sort();
const hash = createHash("sha256");
for (const name of sources) hash.update(readFileSync(join(here, name)));
const banner = { js: `/* mimoc's viewer, built by .ci/task viewer from sources of SHA-256 ${hash.digest("hex")} */` };
await build({ ...usual, banner, entryPoints: [join(here, "main.js")], outfile: join(out, "viewer.js") });
await build({
  ...usual,
  entryPoints: [join(here, "engine.js")],
  outfile: join(out, "mujoco.js"),
  external: ["module"], // Only Node.js loads it.
  define: { "import.meta.url": '"file:///mujoco.js"' }, // The page has the WebAssembly itself.
});
writeFileSync(join(out, "mujoco.wasm.gz"), gzipSync(readFileSync(join(modules, "@mujoco/mujoco/mujoco.wasm")), { level: 9 }));

const licence = (name) => readFileSync(join(modules, name, "LICENSE"), "utf8").trim();
writeFileSync(join(out, "LICENCES.txt"), `This page contains three.js (https://threejs.org):\n\n${licence("three")}\n`);
