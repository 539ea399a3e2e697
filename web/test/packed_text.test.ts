import assert from "node:assert/strict";
import { test } from "node:test";
import { pack, unpack } from "../playground/packed_text.mjs";

test("bytes of every value and length are the same after packing", () => {
  for (let length = 0; length < 300; length++) {
    const bytes = Uint8Array.from({ length }, (_, k) => (37 * k + length) % 256);
    const text = pack(bytes);
    assert.deepEqual(unpack(text), bytes);
    assert.doesNotMatch(text, /[\0\r<]/);
  }
});
