// Writes the bundle that feeler-report embeds, and prints its size.
import { readFileSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { bundle, COMMITTED } from "./bundle.mjs";

await bundle(COMMITTED);
const bytes = readFileSync(COMMITTED);
const kilobytes = (size) => `${(size / 1000).toFixed(0)} kB`;
console.log(`page.js: ${kilobytes(bytes.length)}, gzipped ${kilobytes(gzipSync(bytes).length)}`);
