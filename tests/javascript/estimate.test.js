// An estimate in words: what it is known from, and what has passed of it.

import assert from "node:assert/strict";
import { test } from "node:test";

import { estimateWords, passedWords } from "../../service/safestart_service/static/logic/estimate.js";

test("an estimate says what it is known from", () => {
  const said = (basis, seconds, runs, least_s = null, most_s = null) => estimateWords({ basis, seconds, runs, least_s, most_s });
  assert.match(said(null, null, 0), /not known/);
  assert.match(said("same inputs", 12, 3, 11, 14), /about 12 s.*measured, 3 earlier runs with these inputs, 11 s to 14 s/);
  assert.match(said("same inputs", 12, 1, 12, 12), /1 earlier run with these inputs\./);
  assert.match(said("process", 600, 0), /about 10 min.*calculated/);
  assert.match(said("other inputs", 5, 2, 1, 9), /other inputs took 5\.0 s.*another time/);
});

test("past its estimate a run is promised nothing", () => {
  assert.equal(passedWords(3.4, null), "3 s so far");
  assert.equal(passedWords(3.4, 20), "3 s of about 20 s");
  assert.match(passedWords(31, 20), /longer than the estimated 20 s/);
});
