// Compares runs in the playground with runs of the program FEELER on one core, interleaved, by the best of REPEATS each.
// usage: node tools/measure_runs.mjs FEELER [REPEATS]
import { execFileSync, execSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const EXPERIMENT = "cap-closing";

const [feeler, repeats = "8"] = process.argv.slice(2);
if (!feeler) throw new Error("usage: node tools/measure_runs.mjs FEELER [REPEATS]");
const playground =
  process.env["PLAYGROUND"] ?? fileURLToPath(new URL("../out/playground.html", import.meta.url));

const executablePath = process.env["CHROMIUM"] ?? execSync("command -v chromium").toString().trim();
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
try {
  const page = await browser.newPage();
  page.setDefaultTimeout(180_000);
  await page.goto(pathToFileURL(resolve(playground)).href);
  await page.waitForFunction(() => "feeler" in window);
  for (const sensing of ["direct", "image"]) {
    const [inPage, inProgram] = [[], []];
    for (let repeat = 0; repeat < Number(repeats); repeat++) {
      inPage.push(
        await page.evaluate((settings) => window.feeler.run(settings).then((run) => run.summary), {
          experiment: EXPERIMENT,
          sensing,
        }),
      );
      inProgram.push(program(sensing));
    }
    if (inPage[0].digest !== inProgram[0].digest) throw new Error("the digests differ");
    const best = (runs) => Math.max(...runs.map((run) => run.real_time_factor));
    const [first, fastest, reference] = [inPage[0].real_time_factor, best(inPage), best(inProgram)];
    console.log(
      `${sensing}: page ${fastest.toFixed(1)} (first run ${first.toFixed(1)}), ` +
        `program ${reference.toFixed(1)} times real time; ratio ${(reference / fastest).toFixed(2)}`,
    );
  }
} finally {
  await browser.close();
}

/** Runs the program on one core. Returns the summary of its run. */
function program(sensing) {
  const out = mkdtempSync(join(tmpdir(), "feeler-"));
  const words = ["run", EXPERIMENT, "--sensing", sensing, "--out", join(out, "run")];
  execFileSync("taskset", ["--cpu-list", "0", feeler, ...words], { stdio: "ignore" });
  const summary = JSON.parse(readFileSync(join(out, "run", "summary.json"), "utf8"));
  rmSync(out, { recursive: true });
  return summary;
}
