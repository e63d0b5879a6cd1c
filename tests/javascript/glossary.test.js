// The glossary of the pages and that of the documentation say the same.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { TERMS, meaning } from "../../service/safestart_service/static/logic/glossary.js";
import { FIELDS } from "../../service/safestart_service/static/logic/question.js";

test("docs/glossary.md has every term, and no other", () => {
  const page = readFileSync(new URL("../../docs/glossary.md", import.meta.url), "utf8");
  const told = page.split("\n").filter((line) => line.startsWith("- ")).map((line) => line.slice(2));
  assert.deepEqual(told, TERMS.map(({ term, means }) => `**${term}**: ${means}`));
});

test("a term is found by each of its forms, and by nothing else", () => {
  for (const { term, also = [] } of TERMS) for (const name of [term, ...also]) assert.equal(meaning(` ${name.toUpperCase()} `).term, term);
  assert.equal(meaning("x"), null);
});

test("the words of the operating point and the corridor are explained", () => {
  for (const name of ["omega_t_deg_s", "a_max_m_s2", "horizon_s", "question", "rest", "mean_motion_rad_s", "c_x", "x0_m", "r_h_m", "disturbance_m_s2"]) {
    assert.notEqual(meaning(FIELDS[name].title) ?? meaning(FIELDS[name].title.split(" ")[0]), null, name);
  }
});
