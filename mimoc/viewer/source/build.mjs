// Builds what pages contain (`make viewer`): node build.mjs SOURCE NODE_MODULES

import { build } from "esbuild";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
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
await build({ ...usual, entryPoints: [join(here, "main.js")], outfile: join(out, "viewer.js") });
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
