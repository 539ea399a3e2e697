// Builds the sample pages: bundles sample/make.ts for node and runs it.
import { build } from "esbuild";

const outfile = new URL("../out/make_sample.mjs", import.meta.url).pathname;
await build({
  entryPoints: ["sample/make.ts"],
  outfile,
  bundle: true,
  platform: "node",
  format: "esm",
  packages: "external",
  logLevel: "warning",
});
await import(outfile);
