// Builds the playground: one HTML file with feeler's program, its worker and the page. Needs Rust with the target
// wasm32-unknown-unknown, wasm-bindgen of the version in Cargo.lock, and zstd.
import { build } from "esbuild";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { pack } from "../playground/packed_text.mjs";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const ROOT = here("../..");
const OUT = here("../out/playground.html");
const TARGET = "wasm32-unknown-unknown";
/** Largest size of the page (bytes). */
const LARGEST = 4e6;

function run(program, args, env = {}) {
  execFileSync(program, args, { cwd: ROOT, stdio: "inherit", env: { ...process.env, ...env } });
}

function compile() {
  const target = process.env.CARGO_TARGET_DIR ?? `${ROOT}/target/wasm`;
  run(
    "cargo",
    ["build", "-p", "feeler-wasm", "--profile", "wasm", "--target", TARGET, "--target-dir", target],
    {
      RUSTFLAGS: "-C target-feature=+simd128",
    },
  );
  const bindgen = process.env.WASM_BINDGEN ?? "wasm-bindgen";
  const made = `${target}/${TARGET}/wasm/feeler_wasm.wasm`;
  run(bindgen, ["--target", "web", "--no-typescript", "--out-dir", here("../out/wasm"), made]);
  const wasm = here("../out/wasm/feeler_wasm_bg.wasm");
  const features = [
    "--enable-simd",
    "--enable-bulk-memory",
    "--enable-nontrapping-float-to-int",
    "--enable-sign-ext",
  ];
  run(here("../node_modules/.bin/wasm-opt"), [
    ...features,
    "--enable-mutable-globals",
    "--enable-reference-types",
    "--enable-multivalue",
    "-O2",
    wasm,
    "-o",
    wasm,
  ]);
  return readFileSync(wasm);
}

/** Compresses with zstd, which is a quarter smaller here than what browsers decompress themselves. */
function compressed(bytes) {
  return execFileSync("zstd", ["--ultra", "-22", "--stdout", "--quiet"], {
    input: bytes,
    maxBuffer: 1 << 28,
  });
}

async function bundle(entry) {
  const { outputFiles } = await build({
    entryPoints: [here(entry)],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: "es2022",
    charset: "ascii",
    legalComments: "eof",
    // The program is passed to the worker, not fetched next to its script.
    define: { "import.meta.url": '"about:blank"' },
    loader: { ".css": "text" },
    absWorkingDir: here(".."),
    logLevel: "warning",
  });
  return outputFiles[0].text.replaceAll("</script", "<\\/script");
}

mkdirSync(here("../out/wasm"), { recursive: true });
const wasm = compile();
const style =
  readFileSync(`${ROOT}/crates/feeler-report/src/page.css`, "utf8") +
  readFileSync(here("../playground/style.css"), "utf8");
const parts = {
  style,
  worker: await bundle("../playground/worker.ts"),
  wasm: pack(compressed(wasm)),
  main: await bundle("../playground/main.ts"),
};
let page = readFileSync(here("../playground/template.html"), "utf8");
for (const [name, content] of Object.entries(parts)) {
  // Also removes the white space around the placeholder, which would corrupt the packed bytes.
  page = page.replace(new RegExp(`\\s*/\\*${name}\\*/\\s*`), () => content);
}
writeFileSync(OUT, page);
const kilobytes = (text) => `${(Buffer.byteLength(text) / 1000).toFixed(0)} kB`;
console.log(`playground.html: ${kilobytes(page)}, of which the program ${kilobytes(parts.wasm)}`);
if (Buffer.byteLength(page) > LARGEST) throw new Error(`expected at most ${LARGEST} bytes`);
