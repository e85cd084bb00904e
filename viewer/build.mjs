// node build.mjs FOLDER_OF_PLAYER OUT: bundles the page. player.wasm is in it, as base64: a page from file:// may fetch nothing.

import { build } from "esbuild";
import { copyFileSync, mkdirSync, readFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const [wasmFolder, out] = process.argv.slice(2).map((path) => resolve(path));
const here = dirname(fileURLToPath(import.meta.url));
const notices = readFileSync(join(here, "notices.txt"), "utf8");
const player = {
  name: "player",
  setup: ({ onResolve }) => onResolve({ filter: /^player\.(mjs|wasm)$/ }, ({ path }) => ({ path: join(wasmFolder, path) })),
};
const common = {
  bundle: true,
  minify: true,
  target: ["es2022"],
  loader: { ".wasm": "binary" },
  plugins: [player],
  define: { "import.meta.url": JSON.stringify("") }, // nothing is fetched
  logLevel: "warning",
};
const bundled = (name, options) => build({ ...common, entryPoints: [join(here, "src", name)], ...options });

mkdirSync(out, { recursive: true });
const worker = await bundled("worker.js", { format: "iife", write: false });
const workerText = {
  name: "worker",
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^worker\.bundle\.js$/ }, ({ path }) => ({ path, namespace: "worker" }));
    onLoad({ filter: /.*/, namespace: "worker" }, () => ({ contents: worker.outputFiles[0].text, loader: "text" }));
  },
};
const banner = { js: `/*! ${notices}*/` };
const page = { format: "iife", outfile: join(out, "viewer.js"), plugins: [player, workerText], banner, legalComments: "inline" };
await bundled("main.js", page);
await bundled("simulation.js", { format: "esm", outfile: join(out, "player.mjs"), banner });
for (const name of ["page.html", "viewer.css"]) copyFileSync(join(here, "src", name), join(out, name));
