// Fails unless the committed bundle equals the build output byte for byte.
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { bundle, COMMITTED } from "./bundle.mjs";

const folder = mkdtempSync(join(tmpdir(), "feeler-bundle-"));
try {
  const made = join(folder, "page.js");
  await bundle(made);
  const text = readFileSync(made, "utf8");
  if (!readFileSync(made).equals(readFileSync(COMMITTED))) {
    throw new Error("page.js differs from the build output: run `npm run build` in web/ and commit it");
  }
  // Either would end or swallow the <script> in which the bundle is inlined.
  if (/<\/script|<!--/i.test(text)) throw new Error("the bundle contains </script or <!--");
  console.log("page.js equals the build output");
} finally {
  rmSync(folder, { recursive: true });
}
