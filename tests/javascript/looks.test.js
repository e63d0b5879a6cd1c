// Times in UTC and in the browser's zone; pictures in other colours.

import assert from "node:assert/strict";
import { test } from "node:test";

process.env.TZ = "America/St_Johns";
const { clock, moment } = await import("../../service/safestart_service/static/logic/words.js");
const { recoloured } = await import("../../service/safestart_service/static/logic/recolour.js");

test("a moment says its zone", () => {
  assert.equal(moment("2026-01-02T03:04:05.678Z"), "2026-01-02 03:04:05 UTC");
  assert.equal(moment("2026-01-02T03:04:05Z", true), "2026-01-01 23:34:05 −03:30");
  assert.equal(clock("2026-01-02T03:04:05Z", true), "23:34:05");
  assert.equal(clock("2026-01-02T03:04:05Z"), "03:04:05");
  assert.equal(moment(null, true), "–");
});

test("colours are exchanged and figures stay the same arrays", () => {
  const x = [1, 2], given = [{ name: "#000", line: { color: "#000" }, x, words: ["#000", "b"] }, null];
  const found = recoloured(given, new Map([["#000", "#fff"]]));
  assert.equal(found[0].line.color, "#fff");
  assert.deepEqual(found[0].words, ["#fff", "b"]);
  assert.equal(found[0].x, x);
  assert.equal(given[0].line.color, "#000");
  assert.equal(found[1], null);
});
