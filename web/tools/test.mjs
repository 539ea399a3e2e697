// Runs the tests of a folder with node's test runner. They are bundled first, because it does not read TypeScript.
import { build } from "esbuild";
import { spawnSync } from "node:child_process";
import { readdirSync, rmSync } from "node:fs";
import { fileURLToPath } from "node:url";

const root = fileURLToPath(new URL("..", import.meta.url));
const folder = process.argv[2] ?? "test";
const out = `${root}out/${folder}`;
rmSync(out, { recursive: true, force: true });
const tests = readdirSync(`${root}${folder}`).filter((name) => name.endsWith(".test.ts"));
await build({
  entryPoints: tests.map((name) => `${root}${folder}/${name}`),
  outdir: out,
  outExtension: { ".js": ".mjs" },
  bundle: true,
  platform: "node",
  format: "esm",
  packages: "external",
  sourcemap: "inline",
  logLevel: "warning",
});
const only = process.argv.slice(3);
const made = tests
  .filter((name) => !only.length || only.some((part) => name.includes(part)))
  .map((name) => `${out}/${name.replace(".ts", ".mjs")}`);
const options = ["--test", "--enable-source-maps", "--test-concurrency=2", "--test-reporter=spec"];
process.exit(spawnSync(process.execPath, [...options, ...made], { stdio: "inherit", cwd: root }).status ?? 1);
