// Bundler settings, shared by the build, its check and the sample pages.
import { build } from "esbuild";
import { fileURLToPath } from "node:url";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));

/** The committed bundle, which feeler-report embeds. */
export const COMMITTED = here("../../crates/feeler-report/src/page.js");

const BANNER = "// Made by `npm run build` in web/ from web/src. Do not edit.";

export async function bundle(outfile) {
  await build({
    entryPoints: [here("../src/main.ts")],
    outfile,
    bundle: true,
    minify: true,
    format: "iife",
    target: "es2022",
    charset: "ascii",
    legalComments: "eof",
    loader: { ".css": "text" },
    banner: { js: BANNER },
    absWorkingDir: here(".."),
    logLevel: "warning",
  });
}
