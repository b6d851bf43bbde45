// Builds what pages contain (`make viewer`): node build.mjs SOURCE NODE_MODULES

import { build } from "esbuild";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [, , here, modules] = process.argv;
const out = join(here, "..", "built");
mkdirSync(out, { recursive: true });
await build({
  entryPoints: [join(here, "main.js")],
  outfile: join(out, "viewer.js"),
  nodePaths: [modules],
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  charset: "utf8",
  legalComments: "inline",
});

const licence = (name) => readFileSync(join(modules, name, "LICENSE"), "utf8").trim();
writeFileSync(join(out, "LICENCES.txt"), `This page contains three.js (https://threejs.org):\n\n${licence("three")}\n`);
