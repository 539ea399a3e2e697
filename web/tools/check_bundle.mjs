// Fails unless the committed bundle is what the sources make, byte for byte.
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
    throw new Error("page.js is not what web/src makes: run `npm run build` in web/ and commit it");
  }
  // Either would end or swallow the <script> that it is inlined in.
  if (/<\/script|<!--/i.test(text)) throw new Error("the bundle holds </script or <!--");
  console.log("page.js is what web/src makes");
} finally {
  rmSync(folder, { recursive: true });
}
