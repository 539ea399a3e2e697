// Builds the playground: one HTML file with feeler's program, its worker and the page. Needs Rust with the target
// wasm32-unknown-unknown, and zstd. With --fast, for tests, the page builds in half the time, but is larger and slower;
// this requires a preceding `cargo build --workspace --all-features`.
import { build } from "esbuild";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { pack } from "../playground/packed_text.mjs";

const here = (path) => fileURLToPath(new URL(path, import.meta.url));
const ROOT = here("../..");
const FAST = process.argv.includes("--fast");
const OUT = here(FAST ? "../out/fast" : "../out");
const TARGET = "wasm32-unknown-unknown";
/** Largest size of the page (bytes). */
const LARGEST = 4e6;
// Little optimization, no debug assertions or overflow checks. `build-override` keeps the settings of procedural macros
// and build scripts, so that Cargo reuses those that were built for the workspace's tests.
const FAST_PROFILE = [
  "opt-level=0",
  "package.feeler.opt-level=1",
  "package.glam.opt-level=1",
  ...["feeler-sources", "image", "nalgebra", "parry3d-f64", "rapier3d-f64"].map(
    (name) => `package.${name}.opt-level=0`,
  ),
  ...["debug-assertions", "overflow-checks"].flatMap((check) => [
    `${check}=false`,
    `build-override.${check}=true`,
  ]),
];

function run(program, args, env = {}) {
  execFileSync(program, args, { cwd: ROOT, stdio: "inherit", env: { ...process.env, ...env } });
}

function compile() {
  const target = process.env.CARGO_TARGET_DIR ?? `${ROOT}/target${FAST ? "" : "/wasm"}`;
  const into = `--target-dir=${target}`;
  const profile = FAST
    ? FAST_PROFILE.map((setting) => `--config=profile.dev.${setting}`)
    : ["--profile=wasm"];
  run("cargo", ["build", "-p", "feeler-wasm", "--target", TARGET, into, ...profile], {
    RUSTFLAGS: "-C target-feature=+simd128",
  });
  const made = `${target}/${TARGET}/${FAST ? "debug" : "wasm"}/feeler_wasm.wasm`;
  // Run directly, because `cargo run` would compile feeler-bindgen again, with other features of its dependencies.
  if (FAST) run(`${target}/debug/feeler-bindgen`, [made, here("../out/wasm")]);
  else run("cargo", ["run", "-p", "feeler-bindgen", into, "--", made, here("../out/wasm")]);
  const wasm = here("../out/wasm/feeler_wasm_bg.wasm");
  if (!FAST) optimize(wasm);
  return readFileSync(wasm);
}

function optimize(wasm) {
  const features = [
    "--enable-simd",
    "--enable-bulk-memory",
    "--enable-nontrapping-float-to-int",
    "--enable-sign-ext",
    "--enable-mutable-globals",
    "--enable-reference-types",
    "--enable-multivalue",
  ];
  run(here("../node_modules/.bin/wasm-opt"), [...features, "-O2", wasm, "-o", wasm]);
}

/** Compresses with zstd, which is a quarter smaller here than what browsers decompress themselves. */
function compressed(bytes) {
  const level = FAST ? ["-3"] : ["--ultra", "-22"];
  return execFileSync("zstd", [...level, "--stdout", "--quiet"], {
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

mkdirSync(OUT, { recursive: true });
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
writeFileSync(`${OUT}/playground.html`, page);
const kilobytes = (text) => `${(Buffer.byteLength(text) / 1000).toFixed(0)} kB`;
console.log(`playground.html: ${kilobytes(page)}, of which the program ${kilobytes(parts.wasm)}`);
if (!FAST && Buffer.byteLength(page) > LARGEST) throw new Error(`expected at most ${LARGEST} bytes`);
